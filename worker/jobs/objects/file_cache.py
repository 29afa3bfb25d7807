"""A cache of downloaded files in a folder, with a limit on their size."""

import os
import secrets
import shutil
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

_UNUSED_S = 3600.0  # an unused file is removed then, as its job may have been deleted elsewhere; set by hand


class FileCache:
    """Files that never change, by name; the processes of a machine share the folder."""

    def __init__(self, folder: Path, max_bytes: int) -> None:
        self._folder = folder
        self._max_bytes = max_bytes
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)

    def open(self, name: str, fetch: Callable[[], BinaryIO]) -> BinaryIO:
        """Open a file, after downloading it with a function if it is not in the cache."""
        path = self._folder / name
        with suppress(FileNotFoundError):
            file = path.open("rb")
            os.utime(file.fileno())
            return file
        return self._keep(path, fetch())

    def drop(self, name: str) -> None:
        (self._folder / name).unlink(missing_ok=True)

    def _keep(self, path: Path, file: BinaryIO) -> BinaryIO:
        size_bytes = file.seek(0, os.SEEK_END)
        file.seek(0)
        self._make_room(size_bytes)
        if size_bytes > self._max_bytes:
            return file
        temporary = path.with_name(f".{secrets.token_hex(8)}")
        try:
            with temporary.open("xb") as copy:
                shutil.copyfileobj(file, copy)
            temporary.replace(path)
        except OSError:  # on a full disk the file is not cached
            temporary.unlink(missing_ok=True)
        file.seek(0)
        return file

    def _make_room(self, size_bytes: int) -> None:
        """Remove the files that have been unused for an hour, and then the least recently used ones."""
        files = sorted(_statuses(self._folder), key=lambda one: one[1].st_mtime)
        held_bytes = sum(status.st_size for _, status in files) + size_bytes
        oldest = time.time() - _UNUSED_S
        for path, status in files:
            if status.st_mtime < oldest or held_bytes > self._max_bytes:
                path.unlink(missing_ok=True)
                held_bytes -= status.st_size


def _statuses(folder: Path) -> list[tuple[Path, os.stat_result]]:
    found = []
    for entry in os.scandir(folder):
        with suppress(FileNotFoundError):
            found.append((Path(entry), entry.stat()))
    return found
