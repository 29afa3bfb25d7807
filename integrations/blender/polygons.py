"""Polygons: the file of them that Cleave gets, and their labels from those of the triangles that it makes of them."""

import hashlib
from dataclasses import dataclass

import numpy as np

from .arrays import BoolArray, FloatArray, IntArray

_HEADER = """ply
format binary_little_endian 1.0
element vertex {vertices}
property float x
property float y
property float z
element face {faces}
property list int int vertex_indices
end_header
"""


@dataclass(frozen=True, slots=True, eq=False)
class Polygons:
    """The polygons of a mesh, in its order."""

    vertices: FloatArray  # (V, 3)
    corners: IntArray  # (sum of sizes,) the vertices of all polygons, concatenated
    sizes: IntArray  # (P,) the number of corners of each polygon, at least 3

    @property
    def triangle_count(self) -> int:
        """The number T of triangles: sizes - 2 of each polygon, in the order of the polygons."""
        return int(self.sizes.sum()) - 2 * len(self.sizes)

    def ply(self) -> bytes:
        """A binary PLY file."""
        header = _HEADER.format(vertices=len(self.vertices), faces=len(self.sizes)).encode("ascii")
        rows = np.insert(self.corners, np.cumsum(self.sizes) - self.sizes, self.sizes)
        return header + self.vertices.astype("<f4").tobytes() + rows.astype("<i4").tobytes()

    def labels(self, of_triangles: IntArray) -> IntArray:
        """(P,) the label of each polygon: the one with the largest weight of its triangles, if equal the smallest.

        Parameters
        ----------
        of_triangles : (T,) labels.
        """
        starts = np.cumsum(self.sizes - 2) - (self.sizes - 2)
        labels: IntArray = np.minimum.reduceat(of_triangles, starts).astype(np.int32)
        is_mixed = labels != np.maximum.reduceat(of_triangles, starts)
        if is_mixed.any():
            of_mixed = np.repeat(is_mixed, self.sizes - 2)
            labels[is_mixed] = self._of(is_mixed)._heaviest(of_triangles[of_mixed])
        return labels

    def _of(self, is_chosen: BoolArray) -> "Polygons":
        return Polygons(self.vertices, self.corners[np.repeat(is_chosen, self.sizes)], self.sizes[is_chosen])

    def _heaviest(self, of_triangles: IntArray) -> IntArray:
        width = int(of_triangles.max()) + 1
        pairs, which = np.unique(self._polygon().astype(np.int64) * width + of_triangles, return_inverse=True)
        weight = np.bincount(which, weights=self._weights(), minlength=len(pairs))
        polygon, label = np.divmod(pairs, width)
        order = np.lexsort((label, -weight, polygon))
        first = np.searchsorted(polygon[order], np.arange(len(self.sizes)))
        heaviest: IntArray = label[order][first]
        return heaviest

    def _polygon(self) -> IntArray:
        """(T,) the polygon of each triangle."""
        return np.repeat(np.arange(len(self.sizes), dtype=np.int32), self.sizes - 2)

    def _weights(self) -> FloatArray:
        """(T,) the areas of the triangles, which form a fan around the first corner; 1 in a concave polygon.

        Cleave cuts a concave polygon in another way, which is not known here.
        """
        polygon = self._polygon()
        first = (np.cumsum(self.sizes) - self.sizes)[polygon]
        second = np.arange(len(polygon)) + 2 * polygon + 1  # each polygon has two corners more than triangles
        a, b, c = (self.vertices[self.corners[at]].astype(np.float64) for at in (first, second, second + 1))
        doubled = np.cross(b - a, c - a)
        normal = np.stack([np.bincount(polygon, column, len(self.sizes)) for column in doubled.T], axis=1)
        is_turned = np.einsum("ij,ij->i", doubled, normal[polygon]) < 0.0
        is_concave = np.bincount(polygon, is_turned, len(self.sizes)) > 0
        weights: FloatArray = np.where(is_concave[polygon], 1.0, np.linalg.norm(doubled, axis=1)).astype(np.float32)
        return weights


def digest(*pieces: bytes) -> str:
    """A name for some bytes, the same for the same bytes."""
    return hashlib.sha256(b"".join(pieces)).hexdigest()
