"""A ZIP archive of meshes, unpacked member by member under limits: nothing in it is believed, no name is a path."""

import os
import struct
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path, PurePosixPath

from cleave.settings import Settings
from service.problems import Problem
from service.submit.form import ReceivedMesh, write_capped
from worker.jobs.store.upload import MeshUpload

_PIECE_BYTES = 1024 * 1024
_END = b"PK\5\6"  # of the central directory, with its size 12 bytes further on
_LONGEST_END = 22 + 65_535  # with the longest comment
_ENTRY_BYTES = 1024  # of the central directory, for one member; names are not longer than that
_SPARE_ENTRIES = 1024  # folders and what systems add


def unpack(path: Path, settings: Settings, begin_upload: Callable[[], MeshUpload]) -> list[ReceivedMesh]:
    """The meshes in an archive, in its order.

    Raises
    ------
    Problem
        Where it is no readable ZIP archive, has no members, or is larger than a limit, packed or unpacked.
    """
    _check_directory(path, settings)
    meshes: list[ReceivedMesh] = []
    left = settings.max_batch_bytes
    try:
        with zipfile.ZipFile(path) as archive:
            for member in _members(archive):
                if len(meshes) == settings.max_batch_jobs:
                    raise Problem("too_large", f"A batch has at most {settings.max_batch_jobs} jobs.")
                upload = begin_upload()
                with archive.open(member) as source:
                    while piece := source.read(_PIECE_BYTES):
                        write_capped(upload, piece, min(settings.max_upload_bytes, left))
                upload.close()
                left -= upload.size_bytes
                meshes.append(ReceivedMesh(upload, member.filename))
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, ValueError) as error:
        raise Problem("malformed_request", "The archive is damaged, encrypted or not ZIP: make it again.") from error
    if not meshes:
        raise Problem("malformed_request", "The archive holds no files: put the meshes into it.")
    return meshes


def _members(archive: zipfile.ZipFile) -> Iterator[zipfile.ZipInfo]:
    """The files that a person put in, without folders and without what systems add."""
    for member in archive.infolist():
        parts = PurePosixPath(member.filename).parts
        if not member.is_dir() and not any(part.startswith(".") or part == "__MACOSX" for part in parts):
            yield member


def _check_directory(path: Path, settings: Settings) -> None:
    """Refuse a list of contents that would take much memory to read."""
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(max(0, size - _LONGEST_END))
        tail = file.read()
    at = tail.rfind(_END)
    if at < 0 or len(tail) < at + 16:
        raise Problem("malformed_request", "The archive is damaged or not ZIP: make it again.")
    (directory_bytes,) = struct.unpack_from("<I", tail, at + 12)
    if directory_bytes > (settings.max_batch_jobs + _SPARE_ENTRIES) * _ENTRY_BYTES:
        raise Problem(
            "too_large", f"The archive has too many members: a batch has at most {settings.max_batch_jobs} jobs."
        )
