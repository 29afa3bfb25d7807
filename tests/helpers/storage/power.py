"""What a crash of the machine leaves in the worst case: only what was synchronised to the disk."""

import os
from pathlib import Path

import pytest


class Disk:
    """Records what is synchronised, from when it is made: the bytes of files, and the names in folders."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self._bytes: dict[int, bytes] = {}  # by inode
        self._names: dict[int, dict[str, int]] = {}  # by the inode of the folder; the inode of each name
        self._folders: set[int] = set()  # among those names
        fsync = os.fsync

        def recording(descriptor: int) -> None:
            fsync(descriptor)
            self._record(Path(os.readlink(f"/proc/self/fd/{descriptor}")))

        monkeypatch.setattr(os, "fsync", recording)

    def has_bytes(self, path: Path) -> bool:
        """Whether the bytes of a file are on the disk, whatever its names."""
        return self._bytes.get(path.stat().st_ino) == path.read_bytes()

    def leave(self, folder: Path, target: Path) -> Path:
        """Copy what is left of a folder, which existed before, to a new one and return that."""
        target.mkdir(parents=True)
        self._copy(folder.stat().st_ino, target)
        return target

    def _record(self, path: Path) -> None:
        inode = path.stat().st_ino
        if path.is_dir():
            self._names[inode] = {one.name: one.stat().st_ino for one in path.iterdir()}
            self._folders |= {one.stat().st_ino for one in path.iterdir() if one.is_dir()}
        else:
            self._bytes[inode] = path.read_bytes()

    def _copy(self, folder: int, target: Path) -> None:
        for name, inode in self._names.get(folder, {}).items():
            if inode in self._folders:
                (target / name).mkdir()
                self._copy(inode, target / name)
            else:
                (target / name).write_bytes(self._bytes.get(inode, b""))
