"""Decoder for buffer views of glTF that are compressed with meshoptimizer's codecs."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.errors import InvalidMesh, UnsupportedFormat
from segcore.io.gltf.compression.meshopt_attributes import decode_attributes
from segcore.io.gltf.compression.meshopt_indices import decode_indices, decode_triangles
from segcore.io.gltf.document import Document, Item, integer
from segcore.io.limits import ReadLimits

MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression")
_MOST_PER_BYTE = 1024  # decoded bytes of a byte of data: a control byte codes 4 bytes of up to 256 equal rows
_LARGEST_STRIDE = 256  # bytes, of the extension


def decode_view(document: Document, extension: Item, where: str, limits: ReadLimits) -> memoryview:
    """Return the decoded bytes of a compressed buffer view.

    Raises
    ------
    InvalidMesh
        If the data is damaged.
    UnsupportedFormat
        If it has a filter that is not for positions, indices or normals.
    LimitExceeded
    """
    begin, length = integer(extension, "byteOffset", where, 0), integer(extension, "byteLength", where)
    count, stride = integer(extension, "count", where), integer(extension, "byteStride", where)
    buffer = document.buffer(integer(extension, "buffer", where))
    limits.check("max_uncompressed_bytes", count * stride, "bytes")
    if begin + length > len(buffer) or count * stride > _MOST_PER_BYTE * length or length == 0:
        raise InvalidMesh(f"{where} of the glTF file reaches beyond its data: it is damaged.")
    source = np.frombuffer(buffer, np.uint8, length, begin)
    match extension.get("mode"), extension.get("filter", "NONE"):
        case "ATTRIBUTES", str(name):
            return _filtered(_attributes(source, count, stride, where), name, where).reshape(-1).data.cast("B")
        case ("TRIANGLES" | "INDICES") as mode, "NONE":
            return _indices(source, count, stride, mode, where).data.cast("B")
        case _:
            raise InvalidMesh(f"{where} of the glTF file has an unknown mode or filter: it is damaged.")


def _attributes(source: NDArray[np.uint8], count: int, stride: int, where: str) -> NDArray[np.uint8]:
    """(count, stride) bytes."""
    target = np.empty((count, stride), np.uint8)
    if stride % 4 or not 0 < stride <= _LARGEST_STRIDE or not decode_attributes(source, target):
        raise _damaged(where)
    return target


def _indices(source: NDArray[np.uint8], count: int, stride: int, mode: str, where: str) -> NDArray[Any]:
    target = np.empty(count, np.int64)
    if stride not in (2, 4) or count > 3 * len(source) or (mode == "TRIANGLES" and count % 3):
        raise _damaged(where)
    decoder = decode_triangles if mode == "TRIANGLES" else decode_indices
    if not decoder(source, target) or (count and not 0 <= target.min() <= target.max() < 256**stride):
        raise _damaged(where)
    return target.astype(f"<u{stride}")


def _filtered(data: NDArray[np.uint8], name: str, where: str) -> NDArray[Any]:
    """Decode the filter called ``name`` (appendix B of the extension)."""
    stride = data.shape[1]
    if name == "NONE":
        return data
    if name == "EXPONENTIAL":
        words = data.view("<i4")
        return np.ldexp((words << 8 >> 8).astype(np.float32), words >> 24).astype("<f4")
    if name == "OCTAHEDRAL" and stride in (4, 8):
        return _octahedral(data.view(f"<i{stride // 4}").reshape(-1, 4))
    raise UnsupportedFormat(
        f"{where} of the glTF file has the filter {name[:40]!r}, which cannot be decoded: save it without compression."
    )


def _octahedral(rows: NDArray[Any]) -> NDArray[Any]:
    largest = np.iinfo(rows.dtype).max
    x, y = (rows[:, i] / np.maximum(rows[:, 2], 1).astype(np.float32) for i in range(2))
    z = 1 - np.abs(x) - np.abs(y)
    folded = np.maximum(-z, 0)
    x, y = x - np.copysign(folded, x), y - np.copysign(folded, y)
    scale = largest / np.sqrt(x * x + y * y + z * z)
    result = rows.copy()
    result[:, :3] = np.round(np.stack([x, y, z], axis=1) * scale[:, None])
    return result


def _damaged(where: str) -> InvalidMesh:
    return InvalidMesh(f"The compressed data of {where} of the glTF file is damaged or cut short.")
