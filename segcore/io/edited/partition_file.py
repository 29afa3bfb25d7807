"""Parts as bytes: for the store, and between processes.

Four bytes, the length of a header (little-endian); the header, the JSON ``{"faces": F, "parts": [...]}`` with an entry
of :func:`part_document` for each part; the labels of the faces as little-endian int32, compressed with zlib.
"""

import json
import struct
import zlib
from typing import Any

import numpy as np

from segcore.errors import InvalidMesh, InvalidParameters
from segcore.partition import Part, Partition

_LENGTH = struct.Struct("<I")
_LEVEL = 1  # of zlib: labels of neighbours are equal, so that higher levels gain little


def part_document(part: Part) -> dict[str, Any]:
    """Return a part as JSON values: ``name`` and ``class`` (empty for none), ``color`` (or null) and ``locked``."""
    return {"name": part.name, "color": part.color, "class": part.class_name, "locked": part.locked}


def part_of(document: dict[str, Any]) -> Part:
    """Return the part of a document of :func:`part_document`.

    Raises
    ------
    InvalidMesh
        If it is no such document.
    """
    try:
        name, color, class_name = document["name"], document["color"], document["class"]
        is_text = isinstance(name, str) and isinstance(class_name, str)
        if is_text and (color is None or len(bytes.fromhex(str(color).removeprefix("#"))) == 3):
            return Part(name, color, class_name, bool(document["locked"]))
    except (KeyError, TypeError, ValueError):
        pass
    raise InvalidMesh("What is said about a part is damaged: make the file again.")


def encode_partition(partition: Partition) -> bytes:
    """Return parts as bytes."""
    parts = [part_document(part) for part in partition.parts]
    header = json.dumps({"faces": len(partition.labels), "parts": parts}, separators=(",", ":")).encode()
    return _LENGTH.pack(len(header)) + header + zlib.compress(partition.labels.astype("<i4").tobytes(), _LEVEL)


def decode_partition(data: bytes) -> Partition:
    """Return the parts in bytes of :func:`encode_partition`.

    Raises
    ------
    InvalidMesh
        If the bytes are damaged.
    """
    try:
        (length,) = _LENGTH.unpack_from(data)
        header = json.loads(data[_LENGTH.size : _LENGTH.size + length])
        size = 4 * header["faces"]
        packed = zlib.decompressobj()
        labels = packed.decompress(data[_LENGTH.size + length :], size + 1)
        if len(labels) != size or not packed.eof:
            raise ValueError("the labels have another size")
        parts = tuple(part_of(document) for document in header["parts"])
        return Partition(np.frombuffer(labels, "<i4").astype(np.int32), parts)
    except (struct.error, zlib.error, KeyError, TypeError, ValueError, InvalidParameters) as error:
        raise InvalidMesh("The parts are damaged: edit them again.") from error
