"""From triangles, which Cleave labels, to polygons."""

import hashlib

import numpy as np

from .arrays import FloatArray, IntArray


def polygon_labels(labels: IntArray, polygon: IntArray, area: FloatArray, count: int) -> IntArray:
    """(P,) the label of each polygon: the one with the largest area of its triangles, at equal areas the smallest.

    Parameters
    ----------
    labels : (T,) of the triangles.
    polygon : (T,) the polygon that each triangle is a piece of; each of 0..count - 1 occurs.
    area : (T,) of the triangles.
    """
    width = int(labels.max(initial=0)) + 1
    pairs, which = np.unique(polygon.astype(np.int64) * width + labels, return_inverse=True)
    weight = np.bincount(which, weights=area, minlength=len(pairs))
    of_polygon, label = np.divmod(pairs, width)
    order = np.lexsort((label, -weight, of_polygon))
    first = np.searchsorted(of_polygon[order], np.arange(count))
    chosen: IntArray = label[order][first].astype(np.int32)
    return chosen


def triangle_areas(vertices: FloatArray, triangles: IntArray) -> FloatArray:
    """(T,) the areas of triangles (T, 3) of vertices (V, 3)."""
    a, b, c = (vertices[triangles[:, corner]].astype(np.float64) for corner in range(3))
    areas: FloatArray = (np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2).astype(np.float32)
    return areas


def encode_ply(vertices: FloatArray, triangles: IntArray) -> bytes:
    """A binary PLY file of vertices (V, 3) and triangles (T, 3), in their order."""
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.zeros(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    rows["count"], rows["corners"] = 3, triangles
    return header.encode("ascii") + vertices.astype("<f4").tobytes() + rows.tobytes()


def digest(*pieces: bytes) -> str:
    """A name for some bytes, the same for the same bytes."""
    return hashlib.sha256(b"".join(pieces)).hexdigest()
