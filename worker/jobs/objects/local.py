"""Object storage in a folder, which the processes of a machine share, or machines that mount it."""

import errno
import heapq
import os
import secrets
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from worker.jobs.objects.durable import TEMPORARY_SUFFIX, create_file, link_file, replace_file, sync_folder, sync_path
from worker.jobs.objects.interface import Item, ObjectInfo, Value

_TRIES = 10  # to write into a folder that other processes remove while it is empty; set by hand


class LocalObjects:
    """The files below a folder; the file system must support hard links."""

    survives_fork = True
    poll_interval_s = 0.0

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def create(self, key: str, data: bytes) -> bool:
        path = self._path(key)
        return self._in_folder(path.parent, lambda: create_file(path, data))

    def put(self, key: str, data: bytes, *, durable: bool = True) -> None:
        path = self._path(key)
        if data:
            self._in_folder(path.parent, lambda: replace_file(path, lambda file: file.write(data), durable=durable))
        else:  # an empty file cannot be incomplete
            self._in_folder(path.parent, path.touch)
            sync_folder(path.parent)

    def put_file(self, key: str, path: Path) -> None:
        target = self._path(key)
        sync_path(path)
        try:
            self._in_folder(target.parent, lambda: os.replace(path, target))
        except OSError as error:
            if error.errno != errno.EXDEV:
                raise
            with path.open("rb") as source:
                replace_file(target, lambda copy: shutil.copyfileobj(source, copy))
        sync_folder(target.parent)

    def copy(self, key: str, target: str) -> None:
        source, path = self._path(key), self._path(target)
        source.stat()  # a FileNotFoundError below then means that the folder was removed
        self._in_folder(path.parent, lambda: link_file(source, path))

    def get(self, key: str) -> bytes | None:
        try:
            return self._path(key).read_bytes()
        except (FileNotFoundError, NotADirectoryError):
            return None

    def open(self, key: str) -> BinaryIO:
        return self._path(key).open("rb")

    def exists(self, key: str) -> bool:
        return self._path(key).exists()

    def delete(self, key: str) -> None:
        path = self._path(key)
        with suppress(FileNotFoundError, NotADirectoryError):
            path.unlink()
        if key.count("/") > 1:  # the folder of a job or an owner is removed with its last object
            with suppress(OSError):
                path.parent.rmdir()

    def keys_below(self, folder: str, after: str = "", limit: int | None = None) -> list[str]:
        keys = (key for key in _keys(self._path(folder), folder) if key > after)
        return sorted(keys) if limit is None else heapq.nsmallest(limit, keys)

    def list_below(self, folder: str) -> list[ObjectInfo]:
        found = ((key, _status(self._path(key))) for key in self.keys_below(folder))
        return [ObjectInfo(key, status.st_size, status.st_mtime) for key, status in found if status is not None]

    def each(self, work: Callable[[Item], Value], items: Iterable[Item]) -> list[Value]:
        return [work(item) for item in items]

    def presigned_url(self, key: str, valid_s: float) -> None:  # noqa: ARG002
        return None

    def check_writable(self) -> None:
        probe = f"incoming/{secrets.token_hex(16)}/probe"
        try:
            self.create(probe, b"?")
        finally:
            self.delete(probe)

    def _path(self, key: str) -> Path:
        return self._folder / key

    def _in_folder(self, folder: Path, write: Callable[[], Value]) -> Value:
        """Write into a folder, which is created if needed, and again if another process removes it meanwhile."""
        for _ in range(_TRIES):
            _make_folder(folder)
            with suppress(FileNotFoundError):
                return write()
        _make_folder(folder)
        return write()


def _make_folder(folder: Path) -> None:
    """Create a folder, and those above it, durably."""
    if folder.is_dir():
        return
    _make_folder(folder.parent)
    folder.mkdir(mode=0o700, exist_ok=True)
    with suppress(FileNotFoundError):
        sync_folder(folder.parent)


def _keys(path: Path, key: str) -> Iterator[str]:
    try:
        entries = list(os.scandir(path))
    except (FileNotFoundError, NotADirectoryError):
        return
    for entry in entries:
        below = f"{key}/{entry.name}"
        if entry.is_dir(follow_symlinks=False):
            yield from _keys(Path(entry), below)
        elif not (entry.name.startswith(".") and entry.name.endswith(TEMPORARY_SUFFIX)):
            yield below


def _status(path: Path) -> os.stat_result | None:
    try:
        return path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return None
