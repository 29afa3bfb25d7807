"""Object storage in a folder, which the processes of a machine share, or machines that mount it."""

import errno
import os
import secrets
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from functools import partial
from itertools import islice
from pathlib import Path
from typing import BinaryIO

from worker.jobs.objects.durable import TEMPORARY_SUFFIX, create_file, link_file, replace_file, sync_folder, sync_path
from worker.jobs.objects.interface import Item, ObjectInfo, Value, name_of

_TRIES = 10  # to write into a folder that other processes remove while it is empty; set by hand


class LocalObjects:
    """The files below a folder; the file system must support hard links."""

    survives_fork = True
    poll_interval_s = 0.0

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def create(self, key: str, data: bytes, *, durable: bool = True) -> bool:
        path = self._path(key)
        return self._in_folder(path.parent, lambda: create_file(path, data, durable=durable), durable=durable)

    def put(self, key: str, data: bytes, *, durable: bool = True) -> None:
        path = self._path(key)
        if data:
            write = partial(replace_file, path, lambda file: file.write(data), durable=durable)
            self._in_folder(path.parent, write, durable=durable)
            return
        self._in_folder(path.parent, path.touch, durable=durable)  # an empty file cannot be incomplete
        if durable:
            sync_folder(path.parent)

    def put_file(self, key: str, path: Path) -> None:
        target = self._path(key)
        sync_path(path)
        try:
            self._in_folder(target.parent, lambda: os.replace(path, target), durable=False)
        except OSError as error:
            if error.errno != errno.EXDEV:
                raise
            _copy_bytes(path, target)

    def copy(self, key: str, target: str) -> None:
        source, path = self._path(key), self._path(target)
        source.stat()  # a FileNotFoundError below then means that the folder was removed
        try:
            self._in_folder(path.parent, lambda: link_file(source, path))
        except OSError as error:
            if error.errno != errno.EMLINK:  # a file has at most 65,000 names in ext4
                raise
            _copy_bytes(source, path)

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
        with suppress(OSError):  # folders that are empty now are removed, except those at the top
            for parent in islice(path.parents, max(0, key.count("/") - 1)):
                parent.rmdir()

    def keys_below(self, folder: str, after: str = "", limit: int | None = None) -> list[str]:
        return list(islice(_in_order(self._path(folder), folder, after), limit))

    def list_below(self, folder: str, after: str = "", limit: int | None = None) -> list[ObjectInfo]:
        found = ((key, _status(self._path(key))) for key in self.keys_below(folder, after, limit))
        return [ObjectInfo(key, status.st_size, status.st_mtime) for key, status in found if status is not None]

    def walk(self, folder: str) -> Iterator[str]:
        return _in_any_order(self._path(folder), folder)

    def each(self, work: Callable[[Item], Value], items: Iterable[Item]) -> list[Value]:
        return [work(item) for item in items]

    def presigned_url(self, key: str, valid_s: float) -> None:  # noqa: ARG002
        return None

    def sync(self, keys: Iterable[str]) -> None:
        paths = [(self._path(key), key.count("/") + 1) for key in keys]
        folders = {folder for path, depth in paths for folder in islice(path.parents, depth)}
        for sync, path in [*((sync_path, path) for path, _ in paths), *((sync_folder, folder) for folder in folders)]:
            with suppress(FileNotFoundError):
                sync(path)

    def check_writable(self) -> None:
        probe = f"incoming/{secrets.token_hex(16)}/probe"
        try:
            self.create(probe, b"?")
        finally:
            self.delete(probe)

    def _path(self, key: str) -> Path:
        return self._folder / key

    def _in_folder(self, folder: Path, write: Callable[[], Value], *, durable: bool = True) -> Value:
        """Write into a folder, which is created if needed, and again if another process removes it meanwhile."""
        for _ in range(_TRIES):
            with suppress(FileNotFoundError):
                _make_folder(folder, durable)
                return write()
        _make_folder(folder, durable)
        return write()


def _make_folder(folder: Path, durable: bool) -> None:
    """Create a folder, and those above it."""
    if folder.is_dir():
        return
    _make_folder(folder.parent, durable)
    folder.mkdir(mode=0o700, exist_ok=True)
    if durable:
        with suppress(FileNotFoundError):
            sync_folder(folder.parent)


def _copy_bytes(source: Path, target: Path) -> None:
    with source.open("rb") as file:
        replace_file(target, lambda copy: shutil.copyfileobj(file, copy))


def _in_order(path: Path, key: str, after: str) -> Iterator[str]:
    """Yield the keys below a folder that follow a key, in order; a folder is read when its first key is needed."""
    names = [f"{key}/{name}" for name in _names(path)]
    if after:
        names = [one for one in names if one > after or (one.endswith("/") and after.startswith(one))]
    for below in sorted(names):
        if below.endswith("/"):
            yield from _in_order(path / name_of(below[:-1]), below[:-1], after)
        else:
            yield below


def _in_any_order(path: Path, key: str) -> Iterator[str]:
    for name in _names(path):
        if name.endswith("/"):
            yield from _in_any_order(path / name[:-1], f"{key}/{name[:-1]}")
        else:
            yield f"{key}/{name}"


def _names(path: Path) -> Iterator[str]:
    """Yield the names in a folder as the system returns them; those of folders end with a slash."""
    try:
        with os.scandir(path) as entries:
            for entry in entries:
                if entry.is_dir(follow_symlinks=False):
                    yield f"{entry.name}/"
                elif not (entry.name.startswith(".") and entry.name.endswith(TEMPORARY_SUFFIX)):
                    yield entry.name
    except (FileNotFoundError, NotADirectoryError):
        return


def _status(path: Path) -> os.stat_result | None:
    try:
        return path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return None
