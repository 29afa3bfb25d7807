"""read_source: the bytes of a path or a binary file, decompressed if they are gzip, within the limits."""

import os
import zlib
from collections.abc import Iterator
from typing import BinaryIO

from segcore.errors import InvalidMesh, LimitExceeded
from segcore.io.limits import ReadLimits

GZIP_MAGIC = b"\x1f\x8b"
_UTF_16 = {b"\xff\xfe": ("utf-16-le", 1), b"\xfe\xff": ("utf-16-be", 0)}  # and the place of the high byte
_BEGINNING = 64  # bytes that are looked at, set by hand
_CHUNK = 2**20  # bytes read or decompressed at a time; bounds the memory beyond a limit
_GZIP_WINDOW = 31  # zlib's code for: 32 KiB window, gzip header and checksum


def read_source(source: str | os.PathLike[str] | BinaryIO, limits: ReadLimits) -> bytes:
    """Return the contents of a path or a binary file, decompressed if they are gzip.

    Raises
    ------
    LimitExceeded
        If there are more bytes than ``limits`` allows, before or after decompression.
    InvalidMesh
        If there are none, or if the compressed data is damaged or cut short.
    OSError
        If a path cannot be read.
    """
    data = _read_path(source, limits) if isinstance(source, str | os.PathLike) else _read_file(source, limits)
    if data.startswith(GZIP_MAGIC):
        data = _gunzip(data, limits)
    if not data:
        raise InvalidMesh("The file is empty: send a mesh file.")
    return data


def without_utf_16(data: bytes) -> bytes:
    """Return a text in UTF-16, as some consoles of Windows write it, in UTF-8; return other bytes as they are.

    It is a text in UTF-16 if it begins with a byte order mark and characters of Latin-1.

    Raises
    ------
    InvalidMesh
        If it is damaged.
    """
    encoding, high = _UTF_16.get(data[:2], ("", 0))
    if not encoding or data[2 + high : _BEGINNING : 2].strip(b"\0") or 0 in data[3 - high : _BEGINNING : 2]:
        return data
    try:
        return data[2:].decode(encoding).encode()
    except UnicodeDecodeError as error:
        raise InvalidMesh("The file is a text in UTF-16 that is damaged or cut short: save it as UTF-8.") from error


def _read_path(path: str | os.PathLike[str], limits: ReadLimits) -> bytes:
    with open(path, "rb") as file:
        return _read_file(file, limits)


def _read_file(file: BinaryIO, limits: ReadLimits) -> bytes:
    piece = max(_bytes_left(file), _CHUNK)  # if the size is known, one read and no second copy
    limits.check("max_bytes", piece if piece > _CHUNK else 0, "bytes")
    return _join(iter(lambda: file.read(piece), b""), limits, "max_bytes")


def _bytes_left(file: BinaryIO) -> int:
    """The number of bytes from the current position to the end; 0 if the file is not seekable."""
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
    while data.startswith(GZIP_MAGIC, at):  # a gzip file is a sequence of members
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
