"""Detection of a plane in which a surface is its own mirror image, whatever its meshing.

Candidates are the planes through the centroid of the area that are normal to an axis of the coordinates or to a
principal axis of the area. A candidate is tested on points spread evenly over the area: the image of a point has to lie
on the surface, with the mirrored normal. Folds and layers close to each other can fail this test, because the points do
not resolve them. A candidate that fails by little is therefore accepted as well if the images of the vertices are
vertices.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from segcore.array_kernels import area_moments
from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.clean.surface import Surface
from segcore.coarsen.contacts import spread_points

# All set by hand.
_POINTS = 8192  # that represent the surface; their spacing is sqrt(1 / 8192) = 1 / 90 of the size
_TESTED = 2048  # of them whose images are tested
_PROBES = 128  # tested first, to reject most candidates at little cost
_NEIGHBOURS = 4  # nearest points, one of which has to agree with an image: beside a crease the nearest may not
_DISTANCE = 0.005  # of an image from the tangent plane of a point of the surface, in sqrt(total area)
_REACH = 2.5  # of an image from that point, in spacings
_NORMALS = 0.8  # least cosine between the mirrored normal and that of the point
_PROBABLE = 0.85  # share of the points that agree below which a candidate is given up
SYMMETRIC = 0.98  # least share of the points that agree
_VERTEX_DISTANCE = 0.2  # of the image of a vertex from a vertex, in the square root of the mean area of a face
_REFINEMENTS = 3  # of a candidate that is nearly symmetric
_BETTER = 0.005  # increase of the share by a refinement below which there is no further one
_SAME_AXIS = 0.9999  # cosine from which two axes are one
_COORDINATES = 1.05  # factor on the variance along an axis of the coordinates, on which authors place planes


@dataclass(frozen=True, slots=True, eq=False)
class Reflection:
    """The reflection in the plane {x : normal . x = offset}."""

    normal: FloatArray  # (3,) of length 1
    offset: float

    def heights(self, points: FloatArray) -> FloatArray:
        """(P,) signed distances of points (P, 3) from the plane."""
        heights: FloatArray = points @ self.normal - self.offset
        return heights

    def of_points(self, points: FloatArray) -> FloatArray:
        """(P, 3) the mirror images of points (P, 3)."""
        images: FloatArray = points - 2.0 * self.heights(points)[:, None] * self.normal
        return images

    def of_directions(self, directions: FloatArray) -> FloatArray:
        """(P, 3) the mirror images of directions (P, 3)."""
        images: FloatArray = directions - 2.0 * (directions @ self.normal)[:, None] * self.normal
        return images

    @classmethod
    def between(cls, points: FloatArray, images: FloatArray) -> "Reflection":
        """The reflection that maps points (P, 3) to images (P, 3) with the least sum of squared distances.

        With both sets around the common centre, sum |image - reflected point|^2 = constant + 4 n . M n, M being the
        symmetric part of sum point image^T. The normal n is therefore the eigenvector of the least eigenvalue of M.
        """
        centre = 0.5 * (points.mean(axis=0) + images.mean(axis=0))
        product = np.einsum("ki,kj->ij", points - centre, images - centre)
        normal = np.linalg.eigh(product + product.T)[1][:, 0]
        return cls(normal, float(normal @ centre))


def find_reflection(surface: Surface) -> Reflection | None:
    """The reflection that maps a surface to itself, or None if there is none.

    Of several the one with the largest variance of the area along its normal is chosen: it pairs the most distant
    parts.
    """
    if not surface.areas.sum() > 0.0:
        return None
    test = _Test(surface)
    centre, covariance = area_moments(surface.vertices, surface.faces, surface.areas)
    found = []
    for axis, factor in _axes(covariance):
        reflection = test.accepted(Reflection(axis, float(axis @ centre)))
        if reflection is not None:
            found.append((factor * float(axis @ covariance @ axis), reflection))
    return max(found, key=lambda entry: entry[0])[1] if found else None


def _axes(covariance: FloatArray) -> list[tuple[FloatArray, float]]:
    """The candidate normals, each with the factor on its variance; no axis twice."""
    axes = [(axis, _COORDINATES) for axis in np.eye(3)]
    for axis in np.linalg.eigh(covariance)[1].T:
        if all(abs(float(axis @ other)) < _SAME_AXIS for other, _ in axes):
            axes.append((axis, 1.0))
    return axes


class _Test:
    """The points of a surface, and the comparison of their mirror images with it."""

    def __init__(self, surface: Surface) -> None:
        points = spread_points(surface, np.zeros(len(surface.faces), dtype=np.int32), _POINTS)
        self._size = float(np.sqrt(surface.areas.sum()))
        self._points = points.position
        self._normals = surface.normals[points.face]
        self._tree = KDTree(points.position)
        self._surface = surface

    def accepted(self, candidate: Reflection) -> Reflection | None:
        """The candidate, refined if need be, if the surface is symmetric in it."""
        if self._agrees(candidate, len(self._points) // _PROBES)[0].mean() < _PROBABLE:
            return None
        stride = len(self._points) // _TESTED
        before = 0.0
        for _ in range(_REFINEMENTS + 1):
            agrees, nearest = self._agrees(candidate, stride)
            share = float(agrees.mean())
            if share >= SYMMETRIC:
                return candidate
            if share >= _PROBABLE and self._maps_vertices(candidate):
                return candidate
            if share < max(_PROBABLE, before + _BETTER):
                return None
            before = share
            candidate = Reflection.between(self._points[::stride][agrees], self._points[nearest[agrees]])
        return None

    def _agrees(self, reflection: Reflection, stride: int) -> tuple[BoolArray, IntArray]:
        """(P,) True for the tested points whose images lie on the surface, and the nearest point of every image."""
        images = reflection.of_points(self._points[::stride])
        normals = reflection.of_directions(self._normals[::stride])
        distance, near = map(np.asarray, self._tree.query(images, k=_NEIGHBOURS))
        away = np.abs(np.einsum("pki,pki->pk", images[:, None] - self._points[near], self._normals[near]))
        turned = np.einsum("pi,pki->pk", normals, self._normals[near])
        spacing = self._size / np.sqrt(_POINTS)
        close = (distance <= _REACH * spacing) & (away <= _DISTANCE * self._size)
        return (close & (turned >= _NORMALS)).any(axis=1), near[:, 0]

    def _maps_vertices(self, reflection: Reflection) -> bool:
        """True if the images of almost all vertices, by the area of their faces, are next to vertices."""
        vertices, faces, areas = self._surface.vertices, self._surface.faces, self._surface.areas
        most = min(_DISTANCE * self._size, _VERTEX_DISTANCE * self._size / np.sqrt(len(faces)))
        distance = np.asarray(KDTree(vertices).query(reflection.of_points(vertices), distance_upper_bound=most)[0])
        area = group_sums(faces.ravel(), np.repeat(areas, 3), len(vertices))
        return bool(area[distance <= most].sum() >= SYMMETRIC * area.sum())
