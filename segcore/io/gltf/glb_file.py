"""GlbFile: a GLB file that is being composed, and its container."""

import json
import struct
from dataclasses import dataclass
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from segcore.errors import LimitExceeded

_LARGEST_FILE = 2**32 - 1  # the lengths in a GLB file have 32 bits
_WORD = 4  # bytes; the length of each chunk is a multiple of it


@dataclass(frozen=True, slots=True, eq=False)
class GlbFile:
    """A glTF document and the arrays of its one buffer."""

    document: dict[str, Any]
    blobs: list[NDArray[Any]]  # each is a whole number of words

    def append_view(self, values: NDArray[Any], **properties: object) -> int:
        """Append an array to the buffer, aligned to its numbers, and return the index of its buffer view."""
        data = np.ascontiguousarray(values)
        buffer = self.document["buffers"][0]
        gap = -buffer["byteLength"] % max(_WORD, data.dtype.itemsize)
        view = {"buffer": 0, "byteOffset": buffer["byteLength"] + gap, "byteLength": data.nbytes, **properties}
        padding = -data.nbytes % _WORD
        self.blobs.extend(blob for blob in (np.zeros(gap, np.uint8), data, np.zeros(padding, np.uint8)) if blob.size)
        buffer["byteLength"] += gap + data.nbytes + padding
        self.document["bufferViews"].append(view)
        return len(self.document["bufferViews"]) - 1

    def write(self, target: IO[bytes]) -> None:
        """Write the file.

        Raises
        ------
        LimitExceeded
            If it would be larger than the 4 GiB of the format.
        """
        text = json.dumps(self.document, separators=(",", ":"), allow_nan=False).encode("ascii")
        text += b" " * (-len(text) % _WORD)
        binary_length = sum(blob.nbytes for blob in self.blobs)
        length = 12 + 8 + len(text) + 8 + binary_length
        if length > _LARGEST_FILE:
            raise LimitExceeded(f"A GLB file holds at most 4 GiB, and this mesh needs {length} bytes: reduce the mesh.")
        target.write(struct.pack("<4sII", b"glTF", 2, length))
        target.write(struct.pack("<I4s", len(text), b"JSON") + text)
        target.write(struct.pack("<I4s", binary_length, b"BIN\0"))
        for blob in self.blobs:
            target.write(blob.data.cast("B"))
