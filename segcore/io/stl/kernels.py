"""A compiled kernel that finds the faces of binary STL files whose attributes are followed by more bytes."""

from segcore.arrays import LongArray
from segcore.io.text.word_kernels import Bytes
from segcore.jit.decorators import kernel


@kernel
def walk_faces(data: Bytes, begin: int, face: int, starts: LongArray) -> int:
    """Fill ``starts`` (N,) with the offset of each face; the last two of its ``face`` bytes count the bytes after it.

    Returns
    -------
    The offset after the last face, or -1 if the data ends before.
    """
    at = begin
    for i in range(len(starts)):
        starts[i] = at
        at += face
        if at > len(data):
            return -1
        at += int(data[at - 2]) + 256 * int(data[at - 1])
    return at
