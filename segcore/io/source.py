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
        return _read_file(file, limits)


def _read_file(file: BinaryIO, limits: ReadLimits) -> bytes:
    piece = max(_bytes_left(file), _CHUNK)  # a file that knows its size is read at once, without a second copy
    limits.check("max_bytes", piece if piece > _CHUNK else 0, "bytes")
    return _join(iter(lambda: file.read(piece), b""), limits, "max_bytes")


def _bytes_left(file: BinaryIO) -> int:
    """0 where the file does not know."""
    if not file.seekable():
        return 0
    position = file.tell()
    end = file.seek(0, os.SEEK_END)
    file.seek(position)
    return end - position


def _gunzip(data: bytes, limits: ReadLimits) -> bytes:
    try:
        return _join(_gunzip_chunks(data), limits, "max_uncompressed_bytes")
    except zlib.error as error:
        raise InvalidMesh("The gzip compression of the file is damaged: compress it again.") from error


def _gunzip_chunks(data: bytes) -> Iterator[bytes]:
    at = 0
    while data.startswith(GZIP_MAGIC, at):  # a gzip file is one or more members, one after the other
        member, tail = zlib.decompressobj(_GZIP_WINDOW), b""
        while not member.eof:
            if not tail:
                tail = data[at : at + _CHUNK]
                at += len(tail)
            chunk = member.decompress(tail, _CHUNK)
            if not tail and not chunk and not member.eof:
                raise InvalidMesh("The compressed file is cut short: send it again.")
            tail = member.unconsumed_tail
            yield chunk
        at -= len(member.unused_data)
    if data[at:].strip(b"\0"):
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
