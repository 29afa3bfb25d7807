"""Extraction of an untrusted ZIP archive of meshes: sizes are limited, and names are never used as paths."""

import os
import struct
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path, PurePosixPath

from cleave.settings import Settings
from segcore.io import is_hidden
from service.problems import Problem
from service.submit.form import ReceivedMesh, write_capped
from worker.jobs.store.upload import MeshUpload

_CHUNK_BYTES = 1024 * 1024
_END = b"PK\5\6"  # end of central directory record; the size of the directory is 12 bytes after it
_MAX_END_BYTES = 22 + 65_535  # of that record, with the longest comment
_ENTRY_BYTES = 1024  # of the central directory per member, with a name of usual length; set by hand
_SPARE_ENTRIES = 1024  # for folders and files that operating systems add; set by hand


def extract(
    path: Path, settings: Settings, begin_upload: Callable[[], MeshUpload], max_files: int
) -> list[ReceivedMesh]:
    """Write the files of an archive to uploads, in the order of the archive.

    Raises
    ------
    Problem
        If the file is not a readable ZIP archive, contains no files, or exceeds a limit, compressed or not.
    """
    _check_directory(path, settings)
    files: list[ReceivedMesh] = []
    left = settings.max_batch_bytes
    try:
        with zipfile.ZipFile(path) as archive:
            for member in _members(archive):
                if len(files) == max_files:
                    raise Problem("too_large", f"The archive has more than {max_files} files: send fewer at a time.")
                upload = begin_upload()
                with archive.open(member) as source:
                    while chunk := source.read(_CHUNK_BYTES):
                        write_capped(upload, chunk, min(settings.max_upload_bytes, left))
                upload.close()
                left -= upload.size_bytes
                files.append(ReceivedMesh(upload, member.filename))
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, ValueError) as error:
        raise Problem(
            "malformed_request", "The archive is damaged, encrypted or not a ZIP archive: create it again."
        ) from error
    if not files:
        raise Problem("malformed_request", "The archive contains no files: add the meshes to it.")
    return files


def _members(archive: zipfile.ZipFile) -> Iterator[zipfile.ZipInfo]:
    """Yield the files of an archive, without folders, hidden files and files that operating systems add."""
    for member in archive.infolist():
        parts = PurePosixPath(member.filename).parts
        is_folder = not parts or member.filename.endswith("/")  # ``is_dir`` fails if the name is empty
        if not is_folder and not is_hidden(member.filename):
            yield member


def _check_directory(path: Path, settings: Settings) -> None:
    """Check the size of the central directory, which zipfile reads into memory.

    Raises
    ------
    Problem
        If the directory is missing or too large.
    """
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(max(0, size - _MAX_END_BYTES))
        tail = file.read()
    at = tail.rfind(_END)
    if at < 0 or len(tail) < at + 16:
        raise Problem("malformed_request", "The archive is damaged or not a ZIP archive: create it again.")
    (directory_bytes,) = struct.unpack_from("<I", tail, at + 12)
    if directory_bytes > (settings.max_batch_jobs + _SPARE_ENTRIES) * _ENTRY_BYTES:
        raise Problem(
            "too_large", f"The archive has too many members: a batch has at most {settings.max_batch_jobs} jobs."
        )
