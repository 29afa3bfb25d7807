"""Package: the parts of a 3MF file, a ZIP archive, with limits that are checked before a part is unpacked."""

import io
import posixpath
import re
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO

from segcore.errors import InvalidMesh, UnsupportedFormat
from segcore.io.limits import ReadLimits

_MOST_PARTS = 10_000  # set by hand; a package has one part for each model, texture and thumbnail
_CENTRAL_RECORD = b"PK\x01\x02"
_ROOT_RELATIONSHIPS = "_rels/.rels"
_LARGEST_RELATIONSHIPS = 2**20  # bytes, set by hand; the usual file has less than 1 kB
_MODEL_TYPE = b"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
_RELATIONSHIP = re.compile(rb"<(?:\w+:)?Relationship\b[^>]*>")
_TARGET = re.compile(rb"""\bTarget\s*=\s*(?:"([^"]*)"|'([^']*)')""")
_USUAL_MODEL = "3D/3dmodel.model"
_CHUNK = 2**18  # bytes that the XML parser gets at a time
_READ_HERE = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_ENCRYPTED = 0x1


class Package:
    """A package in memory; the unpacked parts together have at most ``limits.max_uncompressed_bytes``."""

    def __init__(self, data: bytes, limits: ReadLimits) -> None:
        if data.count(_CENTRAL_RECORD) > _MOST_PARTS:
            raise InvalidMesh(f"The 3MF file has more than {_MOST_PARTS} parts: it is damaged or not a model.")
        try:
            self._archive = zipfile.ZipFile(io.BytesIO(data))
        except (zipfile.BadZipFile, NotImplementedError, UnicodeDecodeError, ValueError, OverflowError) as error:
            raise InvalidMesh("The ZIP archive of the 3MF file is damaged or cut short: send it again.") from error
        self._parts = {_key(entry.filename): entry for entry in self._archive.infolist()}
        self._limits = limits
        self._unpacked = 0

    def root_model(self) -> str:
        """Return the name of the model part according to the relationships of the package, else the usual one."""
        if _key(_ROOT_RELATIONSHIPS) in self._parts:
            with self._open(_ROOT_RELATIONSHIPS) as part:
                text = part.read(_LARGEST_RELATIONSHIPS)
            for relationship in _RELATIONSHIP.findall(text):
                target = _TARGET.search(relationship)
                if _MODEL_TYPE in relationship and target:
                    return (target[1] or target[2]).decode("utf-8", "replace")
        if _key(_USUAL_MODEL) not in self._parts:
            raise UnsupportedFormat(
                "The ZIP archive contains no 3D model, so it is not a 3MF file: send the mesh itself."
            )
        return _USUAL_MODEL

    def names(self) -> list[str]:
        """Return the names of all parts in a normal form: in lower case, without a slash at the beginning."""
        return list(self._parts)

    def size(self, name: str) -> int:
        """Return the number of bytes that a part unpacks to, as the archive states it."""
        return self._parts[_key(name)].file_size

    def chunks(self, name: str) -> Iterator[bytes]:
        """Yield the bytes of a part in pieces.

        Raises
        ------
        InvalidMesh
            If the part is missing, damaged or cut short.
        UnsupportedFormat
            If it is encrypted or compressed in another way than deflate.
        LimitExceeded
        """
        with self._open(name) as part:
            while chunk := part.read(_CHUNK):
                yield chunk

    @contextmanager
    def _open(self, name: str) -> Iterator[IO[bytes]]:
        entry = self._parts.get(_key(name))
        if entry is None:
            raise InvalidMesh(f"The 3MF file has no part {name[:80]!r}, which it refers to: it is damaged.")
        if entry.compress_type not in _READ_HERE or entry.flag_bits & _ENCRYPTED:
            raise UnsupportedFormat(
                f"Part {name[:80]!r} of the 3MF file is encrypted, or compressed in another way than deflate: "
                "save it in the usual form."
            )
        self._unpacked += entry.file_size
        self._limits.check("max_uncompressed_bytes", self._unpacked, "bytes")
        try:
            with self._archive.open(entry) as part:
                yield part
        except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, ValueError, OverflowError) as error:
            raise InvalidMesh(f"Part {name[:80]!r} of the 3MF file is damaged or cut short: send it again.") from error


def _key(name: str) -> str:
    """The name of a part in a normal form: names may be absolute, and their case does not matter."""
    return posixpath.normpath(name.replace("\\", "/")).strip("/").lower()
