"""Walls of holes, which belong to the body that they lie in."""

import numpy as np
from numpy.typing import NDArray

from segcore.affinity.regions import Regions, regions_of
from segcore.array_kernels import face_centroids
from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.clean.edge_geometry import edge_lengths
from segcore.clean.surface import Surface
from segcore.graphs.surface_graph import connected_components

# Set by hand: decision 27 says what each is for.
_FLAT = np.deg2rad(1.0)  # largest dihedral angle inside a wall: all others are concave
_STEEPEST = np.deg2rad(130.0)  # largest concave angle inside a wall: 120 degrees in a triangular hole
_CREASE = np.deg2rad(30.0)  # least dihedral angle at the end of a wall
_CREASED = 0.9  # least share of the outline of a wall that is a crease
_SMALLEST = 0.001  # share of a wall in its component; smaller ones are too small to be cut off anyway
_LARGEST = 0.2  # the same; larger ones are insides of tubes and vessels
_ONE_SIDED = 0.2  # largest imbalance of the directions from which a wall faces its axis


def hole_walls(surface: Surface, dihedral: FloatArray, in_component: FloatArray) -> BoolArray:
    """(F,) True for the faces of the walls of holes.

    A wall is a connected set of faces that meet flat or concave, ends at creases, has between a thousandth and a fifth
    of the area of its component, and faces its axis from all directions alike, as the wall of a round or polygonal hole
    does, and that of a slot with an open side or the foot of a pillar does not. The bottom of a blind hole belongs to
    its wall.

    Parameters
    ----------
    dihedral : (E,) angles at the dual edges.
    in_component : (F,) ``component_areas(surface)``.
    """
    inner = (dihedral > -_STEEPEST) & (dihedral < _FLAT)
    region = connected_components(surface.edge_faces[inner], len(surface.faces))
    regions = regions_of(surface, region, in_component)
    wall = np.flatnonzero(_may_be_walls(surface, dihedral, inner, regions))
    wall = wall[_face_inward(surface, region, wall)]
    return np.isin(region, wall)


def _may_be_walls(surface: Surface, dihedral: FloatArray, inner: BoolArray, regions: Regions) -> BoolArray:
    """(R,) True for the regions that are hollow, neither tiny nor large, and end at creases."""
    share = regions.area / np.maximum(regions.of_component, np.finfo(float).tiny)
    bent = inner & (dihedral < -_FLAT)
    is_hollow = np.bincount(regions.ends[bent, 0], minlength=len(share)) > 0
    length = edge_lengths(surface)[regions.at_outline]
    creased = np.where(np.abs(dihedral[regions.at_outline]) > _CREASE, length, 0.0)
    ends_at_creases = regions.outline_sums(creased) >= _CREASED * regions.outline_sums(length)
    walls: BoolArray = is_hollow & (share >= _SMALLEST) & (share < _LARGEST) & ends_at_creases
    return walls


def _face_inward(surface: Surface, region: IntArray, chosen: NDArray[np.integer]) -> BoolArray:
    """(C,) True for the chosen regions that face their axis, from all directions alike.

    The axis is the direction that the normals follow least.
    """
    place = np.full(int(region.max()) + 1, -1)
    place[chosen] = np.arange(len(chosen))
    faces = np.flatnonzero(place[region] >= 0)
    of, area, normal = place[region[faces]], surface.areas[faces], surface.normals[faces]

    def sums(values: FloatArray) -> FloatArray:
        return group_sums(of, area * values, len(chosen))

    products = [sums(normal[:, k] * normal[:, m]) for k in range(3) for m in range(3)]
    axes = np.linalg.eigh(np.stack(products, axis=1).reshape(-1, 3, 3))[1]
    place_of_face = face_centroids(surface.vertices, surface.faces[faces])
    centre = np.stack([sums(column) for column in place_of_face.T], axis=1) / sums(np.ones(len(faces)))[:, None]
    outward = np.zeros(len(chosen))
    is_balanced = np.ones(len(chosen), dtype=bool)
    for axis in (1, 2):
        direction = axes[of, :, axis]
        along = np.einsum("ij,ij->i", normal, direction)
        outward += sums(along * np.einsum("ij,ij->i", place_of_face - centre[of], direction))
        is_balanced &= np.abs(sums(along)) <= _ONE_SIDED * sums(np.abs(along))
    return is_balanced & (outward < 0.0)
