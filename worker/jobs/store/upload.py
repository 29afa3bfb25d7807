"""A mesh on its way into the store."""

import hashlib
import shutil
from contextlib import suppress
from pathlib import Path


class MeshUpload:
    """A mesh on its way into the store: hashed as it is written, invisible until it is accepted.

    As a context it removes what was written, unless it was accepted.
    """

    def __init__(self, folder: Path) -> None:
        folder.mkdir(mode=0o700)
        self.folder = folder
        self.path = folder / "mesh"
        self.size_bytes = 0
        self._digest = hashlib.sha256()
        self._file = self.path.open("xb")

    def __enter__(self) -> "MeshUpload":
        return self

    def __exit__(self, *_: object) -> None:
        with suppress(OSError):  # what a full disk has kept back
            self._file.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def write(self, data: bytes | bytearray) -> None:
        self._file.write(data)
        self._digest.update(data)
        self.size_bytes += len(data)

    @property
    def sha256(self) -> str:
        return self._digest.hexdigest()

    def close(self) -> None:
        """End the writing; a second time changes nothing."""
        self._file.close()
