"""ZipMembers: the members of a ZIP archive in memory, with limits that are checked before a member is unpacked."""

import io
import posixpath
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO

from segcore.errors import InvalidMesh, UnsupportedFormat
from segcore.io.limits import ReadLimits

ZIP_MAGIC = b"PK\x03\x04"
MOST_MEMBERS = 10_000  # set by hand; a 3MF file has one for each model, texture and thumbnail
_CENTRAL_RECORD = b"PK\x01\x02"
_CHUNK = 2**18  # bytes that are unpacked at a time
_READ_HERE = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_ENCRYPTED = 0x1


class ZipMembers:
    """An archive in memory; the unpacked members together have at most ``limits.max_uncompressed_bytes``.

    Names are compared in a normal form: they may be absolute, and their case does not matter.
    """

    def __init__(self, data: bytes, limits: ReadLimits, what: str) -> None:
        """Read the list of members.

        Parameters
        ----------
        what : the archive in messages, such as ``3MF file``.

        Raises
        ------
        InvalidMesh
            If the archive is damaged or has too many members.
        """
        if data.count(_CENTRAL_RECORD) > MOST_MEMBERS:
            raise InvalidMesh(f"The {what} has more than {MOST_MEMBERS} parts: it is damaged or not a model.")
        try:
            self._archive = zipfile.ZipFile(io.BytesIO(data))
        except (zipfile.BadZipFile, NotImplementedError, UnicodeDecodeError, ValueError, OverflowError) as error:
            raise InvalidMesh(f"The {what} is damaged or cut short: send it again.") from error
        entries = self._archive.infolist()
        # ``ZipInfo.is_dir`` of Python 3.11 raises IndexError if a name is empty.
        self._members = {normal_name(e.filename): e for e in entries if not e.filename.endswith("/")}
        self._what = what
        self._limits = limits
        self._unpacked = 0

    @property
    def names(self) -> list[str]:
        """The names of the files as the archive has them, in its order."""
        return [entry.filename for entry in self._members.values()]

    def __contains__(self, name: str) -> bool:
        return normal_name(name) in self._members

    @property
    def normal_names(self) -> list[str]:
        """The names of the files in the form in which they are compared: in lower case, without a slash in front."""
        return list(self._members)

    def size(self, name: str) -> int:
        """Return the number of bytes that a member unpacks to, as the archive states it."""
        return self._members[normal_name(name)].file_size

    def read(self, name: str) -> bytes:
        """Return the bytes of a member; see ``chunks``."""
        return b"".join(self.chunks(name))

    def chunks(self, name: str) -> Iterator[bytes]:
        """Yield the bytes of a member in pieces.

        Raises
        ------
        InvalidMesh
            If the member is missing, damaged or cut short.
        UnsupportedFormat
            If it is encrypted or compressed in another way than deflate.
        LimitExceeded
        """
        with self.open(name) as part:
            while chunk := part.read(_CHUNK):
                yield chunk

    @contextmanager
    def open(self, name: str) -> Iterator[IO[bytes]]:
        """Open a member; for the errors see ``chunks``."""
        entry = self._members.get(normal_name(name))
        if entry is None:
            raise InvalidMesh(f"The {self._what} has no part {name[:80]!r}, which it refers to: it is damaged.")
        if entry.compress_type not in _READ_HERE or entry.flag_bits & _ENCRYPTED:
            raise UnsupportedFormat(
                f"Part {name[:80]!r} of the {self._what} is encrypted, or compressed in another way than deflate: "
                "save it in the usual form."
            )
        self._unpacked += entry.file_size
        self._limits.check("max_uncompressed_bytes", self._unpacked, "bytes")
        try:
            with self._archive.open(entry) as part:
                yield part
        except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, ValueError, OverflowError) as error:
            raise InvalidMesh(
                f"Part {name[:80]!r} of the {self._what} is damaged or cut short: send it again."
            ) from error


def normal_name(name: str) -> str:
    """The name of a member in the form in which names are compared."""
    return posixpath.normpath(name.replace("\\", "/")).strip("/").lower()
