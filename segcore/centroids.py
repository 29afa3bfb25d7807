"""The centroids of the faces of a mesh."""

import numpy as np
from numba import njit

from segcore.arrays import FloatArray, IntArray
from segcore.threads import in_blocks


def face_centroids(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """(F, 3) the mean of the three corners of every face."""
    centroids = np.empty((len(faces), 3))
    in_blocks(_write_centroids, len(faces), vertices, faces, centroids)
    return centroids


@njit(cache=True, nogil=True)
def _write_centroids(start, end, vertices, faces, centroids):  # type: ignore[no-untyped-def]
    for f in range(start, end):
        a, b, c = vertices[faces[f, 0]], vertices[faces[f, 1]], vertices[faces[f, 2]]
        for axis in range(3):
            centroids[f, axis] = (a[axis] + b[axis] + c[axis]) / 3.0
