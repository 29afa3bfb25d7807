"""Pictures as PNG files (W3C, Portable Network Graphics, third edition): 8 bits, red, green, blue and opacity."""

import struct
import zlib
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray


def write_png(target: BinaryIO, pixels: NDArray[np.uint8]) -> None:
    """Write (height, width, 4) uint8 pixels, the first row on top."""
    height, width, _ = pixels.shape
    unfiltered = np.zeros((height, 1 + 4 * width), dtype=np.uint8)
    unfiltered[:, 1:] = pixels.reshape(height, -1)
    target.write(b"\x89PNG\r\n\x1a\n")
    _write_chunk(target, b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0))
    _write_chunk(target, b"IDAT", zlib.compress(unfiltered.tobytes(), 9))
    _write_chunk(target, b"IEND", b"")


def _write_chunk(target: BinaryIO, kind: bytes, data: bytes) -> None:
    target.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))
