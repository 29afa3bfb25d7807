"""The open edges of a surface."""

import numpy as np

from segcore.arrays import BoolArray, IntArray
from segcore.clean.topology import DualEdges
from segcore.jit.decorators import kernel


def open_edges(faces: IntArray, dual: DualEdges) -> IntArray:
    """(B, 2) the face and the corner at which every edge of exactly one face begins, in ascending order.

    Parameters
    ----------
    dual : the dual edges of the faces.
    """
    if len(dual.faces) * 2 == 3 * len(faces) and bool(dual.is_manifold.all()):
        return np.empty((0, 2), dtype=np.int32)
    paired = _paired(faces, dual.faces, dual.vertices)
    return np.argwhere(~paired).astype(np.int32)


def ends_of(borders: IntArray, faces: IntArray) -> IntArray:
    """(B, 2) the two vertices of open edges (B, 2), in the order of the face."""
    face, corner = borders.T
    return np.stack([faces[face, corner], faces[face, (corner + 1) % 3]], axis=1)


@kernel
def _paired(faces: IntArray, pairs: IntArray, ends: IntArray) -> BoolArray:
    """(F, 3) True for the edges, each beginning at a corner, that another face has as well."""
    paired = np.zeros((len(faces), 3), np.bool_)
    for e in range(len(pairs)):
        for side in range(2):
            f = pairs[e, side]
            for k in range(3):
                a, b = faces[f, k], faces[f, (k + 1) % 3]
                if min(a, b) == ends[e, 0] and max(a, b) == ends[e, 1]:
                    paired[f, k] = True
    return paired
