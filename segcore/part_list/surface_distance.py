"""Points on a part, and distances of points from its faces."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from segcore.array_kernels import face_centroids
from segcore.arrays import FloatArray, IntArray, LongArray
from segcore.mesh import face_normals_and_areas

# All set by hand.
_SPREAD = 4096  # points, evenly over the area, by which large faces are found
_MOST_CENTROIDS = 131072  # by which small faces are found
_NEAREST = 4  # points of either kind whose faces are measured
_MANY, _WORST = 32, 64  # the same for those points that are farthest from the surface then, and how many these are
# The additive recurrence of Roberts, The unreasonable effectiveness of quasirandom sequences.
_R2 = (0.7548776662466927, 0.5698402909980532)


@dataclass(frozen=True, slots=True, eq=False)
class Anchors:
    """Points on faces."""

    points: FloatArray  # (P, 3)
    face: LongArray  # (P,)


def spread_anchors(vertices: FloatArray, faces: IntArray, areas: FloatArray, count: int) -> Anchors:
    """``count`` points spread evenly over the area of faces, of which at least one has an area."""
    until = np.cumsum(areas)
    at = (np.arange(count) + 0.5) * (until[-1] / count)
    face = np.minimum(np.searchsorted(until, at, side="right"), len(faces) - 1)
    index = np.arange(1, count + 1)
    u, v = (index * _R2[0]) % 1.0, (index * _R2[1]) % 1.0
    beyond = u + v > 1.0
    u, v = np.where(beyond, 1.0 - u, u)[:, None], np.where(beyond, 1.0 - v, v)[:, None]
    a, b, c = vertices[faces[face]].transpose(1, 0, 2)
    return Anchors(a + u * (b - a) + v * (c - a), face)


class SurfaceDistance:
    """Finds the nearest faces of a part.

    The distance is exact for points whose nearest face has one of the nearest anchors, else a little too large. For the
    points that are farthest from the surface, more anchors are considered.
    """

    def __init__(self, vertices: FloatArray, faces: IntArray) -> None:
        normals, areas = face_normals_and_areas(vertices[faces])
        spread = spread_anchors(vertices, faces, areas, _SPREAD)
        step = -(-len(faces) // _MOST_CENTROIDS)
        some = np.arange(0, len(faces), step)
        centroids = Anchors(face_centroids(vertices, faces[some]), some)
        self._corners, self._normals = vertices[faces], normals
        self._kinds = [(KDTree(anchors.points), anchors) for anchors in (spread, centroids)]

    def roughly(self, points: FloatArray) -> FloatArray:
        """(...) distances of points (..., 3) from points of the surface that are spread evenly."""
        return np.asarray(self._kinds[0][0].query(points)[0])

    def __call__(self, points: FloatArray) -> FloatArray:
        """(N,) distances of points (N, 3) from the surface."""
        distance = self._nearest(points, _NEAREST)[1]
        worst = np.argsort(-distance, kind="stable")[:_WORST]
        distance[worst] = np.minimum(distance[worst], self._nearest(points[worst], _MANY)[1])
        return distance

    def quickly(self, points: FloatArray) -> FloatArray:
        """(N,) the same in less time, some of them too large."""
        return self._nearest(points, _NEAREST)[1]

    def planes(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(N, 3) points in the planes of the faces that are nearest to points (N, 3), and (N, 3) their normals."""
        face = self._nearest(points, _NEAREST)[0]
        return self._corners[face, 0], self._normals[face]

    def rough_planes(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The same for the faces of the nearest points that are spread evenly, in less time."""
        tree, anchors = self._kinds[0]
        face = anchors.face[np.asarray(tree.query(points)[1])]
        return self._corners[face, 0], self._normals[face]

    def _nearest(self, points: FloatArray, most: int) -> tuple[LongArray, FloatArray]:
        """(N,) the nearest of the faces of at most ``most`` anchors of either kind, and (N,) their distances."""
        near = []
        for tree, anchors in self._kinds:
            ranks = range(1, min(most, len(anchors.points)) + 1)
            near.append(anchors.face[np.asarray(tree.query(points, k=ranks)[1])])
        face = np.concatenate(near, axis=1)
        every = np.repeat(points, face.shape[1], axis=0)
        distance = distances_from_triangles(every, self._corners[face.reshape(-1)]).reshape(face.shape)
        row, best = np.arange(len(points)), distance.argmin(axis=1)
        return face[row, best], distance[row, best]


def distances_from_triangles(points: FloatArray, corners: FloatArray) -> FloatArray:
    """(N,) the distance of every point (N, 3) from its triangle (N, 3, 3).

    It is that from the plane if the foot of the perpendicular is in the triangle, else that from the nearest edge.
    """
    edges = np.roll(corners, -1, axis=1) - corners
    from_corner = points[:, None] - corners
    squares = np.maximum(np.einsum("nki,nki->nk", edges, edges), np.finfo(float).tiny)
    along = np.clip(np.einsum("nki,nki->nk", from_corner, edges) / squares, 0.0, 1.0)
    from_edges = np.linalg.norm(from_corner - along[:, :, None] * edges, axis=2).min(axis=1)
    normal = np.cross(edges[:, 0], edges[:, 1])
    length = np.linalg.norm(normal, axis=1)
    side = np.einsum("nki,ni->nk", np.cross(edges, from_corner), normal)
    is_above = (side >= 0.0).all(axis=1) & (length > 0.0)
    height = np.abs(np.einsum("ni,ni->n", from_corner[:, 0], normal)) / np.where(length > 0.0, length, 1.0)
    return np.where(is_above, np.minimum(height, from_edges), from_edges)
