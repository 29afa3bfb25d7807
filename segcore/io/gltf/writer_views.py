"""Further buffer views of a GLB file that is being put together."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

_WORD = 4  # bytes; the length of every blob of a GLB file is a multiple of it


def append_view(document: dict[str, Any], blobs: list[NDArray[Any]], values: NDArray[Any], **more: object) -> int:
    """Append an array to the blobs of a document, aligned to its numbers, and a buffer view of it; gives its index."""
    data = np.ascontiguousarray(values)
    buffer = document["buffers"][0]
    gap = -buffer["byteLength"] % max(_WORD, data.dtype.itemsize)
    view = {"buffer": 0, "byteOffset": buffer["byteLength"] + gap, "byteLength": data.nbytes, **more}
    filling = -data.nbytes % _WORD
    blobs += [blob for blob in (np.zeros(gap, np.uint8), data, np.zeros(filling, np.uint8)) if blob.size]
    buffer["byteLength"] += gap + data.nbytes + filling
    document["bufferViews"].append(view)
    return len(document["bufferViews"]) - 1
