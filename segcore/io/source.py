"""The bytes of a mesh file, from wherever they come, within the limits and unpacked."""

import os
import zlib
from collections.abc import Iterator
from typing import BinaryIO

from segcore.errors import InvalidMesh, LimitExceeded
from segcore.io.limits import ReadLimits

GZIP_MAGIC = b"\x1f\x8b"
_CHUNK = 2**20
_GZIP_WINDOW = 31  # zlib's code for: 32 KiB window, gzip header and checksum


def read_source(source: str | os.PathLike[str] | BinaryIO, limits: ReadLimits) -> bytes:
    """Everything that a path or a binary file holds, unpacked where it is compressed with gzip.

    Raises
    ------
    LimitExceeded
        Where there are more bytes than ``limits`` allows, before or after unpacking.
    InvalidMesh
        Where there are none, or where the compressed data is damaged or cut short.
    OSError
        Where a path cannot be read.
    """
    data = _read_path(source, limits) if isinstance(source, str | os.PathLike) else _read_file(source, limits)
    if data.startswith(GZIP_MAGIC):
        data = _gunzip(data, limits)
    if not data:
        raise InvalidMesh("The file is empty: send a mesh file.")
    return data


def _read_path(path: str | os.PathLike[str], limits: ReadLimits) -> bytes:
    with open(path, "rb") as file:
        limits.check("max_bytes", os.fstat(file.fileno()).st_size, "bytes")
        return _read_file(file, limits)


def _read_file(file: BinaryIO, limits: ReadLimits) -> bytes:
    chunks = iter(lambda: file.read(_CHUNK), b"")
    return _join(chunks, limits, "max_bytes")


def _gunzip(data: bytes, limits: ReadLimits) -> bytes:
    try:
        return _join(_gunzip_chunks(data), limits, "max_uncompressed_bytes")
    except zlib.error as error:
        raise InvalidMesh("The gzip compression of the file is damaged: compress it again.") from error


def _gunzip_chunks(data: bytes) -> Iterator[bytes]:
    while data.startswith(GZIP_MAGIC):  # a gzip file is one or more members, one after the other
        member = zlib.decompressobj(_GZIP_WINDOW)
        while not member.eof:
            chunk = member.decompress(data, _CHUNK)
            data = member.unconsumed_tail
            if not chunk and not member.eof:
                raise InvalidMesh("The compressed file is cut short: send it again.")
            yield chunk
        data = member.unused_data
    if data.strip(b"\0"):
        raise InvalidMesh("There is something else after the compressed data of the file: compress it again.")


def _join(chunks: Iterator[bytes], limits: ReadLimits, limit: str) -> bytes:
    parts, size = [], 0
    for chunk in chunks:
        size += len(chunk)
        if size > getattr(limits, limit):
            raise LimitExceeded(
                f"The file has more bytes than {limit} = {getattr(limits, limit)}: reduce the mesh or raise the limit."
            )
        parts.append(chunk)
    return b"".join(parts)
