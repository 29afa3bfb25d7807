"""The upload of a mesh file."""

import hashlib
import shutil
from contextlib import suppress
from pathlib import Path


class MeshUpload:
    """A mesh file that is hashed as it is written, and belongs to no job until JobStore.accept moves it.

    As a context manager it removes the file on exit, unless the file was moved.
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
        with suppress(OSError):  # a full disk may refuse the buffered rest
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
        """Close the file; calling this again has no effect."""
        self._file.close()
