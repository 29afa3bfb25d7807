"""Flat and smoothly bent faces of CAD models and low-poly meshes, which a cut should go around."""

from typing import NamedTuple

import numpy as np

from segcore.affinity.holes import hole_walls
from segcore.affinity.regions import Regions, component_areas, regions_of
from segcore.array_kernels import ascending
from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.clean.edge_geometry import dihedral_angles, edge_lengths
from segcore.clean.surface import Surface
from segcore.graphs.surface_graph import Rows
from segcore.jit.decorators import kernel

# Set by hand; docs/algorithm.md, "Flat faces" in section 2, has what the first two were compared with.
COHESION = 2.0  # factor on the affinity inside flat and convex smooth faces
_EVENNESS = 0.5  # exponent of the affinity inside all smooth faces
_FLAT = np.deg2rad(1.0)  # largest angle of a normal of a flat region to that of its largest face
_SMOOTH = np.deg2rad(15.0)  # largest dihedral angle between the strips of a bent face
_LEAST_SHARE = 0.005  # area of a flat region in the area of its component
_LEAST_BEND = np.deg2rad(3.0)  # mean angle along the outline of a flat region


class SmoothEdges(NamedTuple):
    """Which dual edges lie inside smooth faces, and which faces are walls of holes."""

    flat: BoolArray  # (E,) flat, convex, or in the wall of a hole
    hollow: BoolArray  # (E,) concave
    wall: BoolArray  # (F,) of a hole


def cohesive_weights(smooth: SmoothEdges, weight: FloatArray, length: FloatArray) -> FloatArray:
    """(E,) weights of the dual edges, raised inside flat and smoothly bent faces.

    Inside them the affinity g becomes 2 sqrt(g), and sqrt(g) if the face is bent inwards.

    Parameters
    ----------
    weight, length : (E,) of the dual edges; the affinity is their ratio.
    """
    cohesive = weight.copy()
    for chosen, factor in ((smooth.flat, COHESION), (smooth.hollow, 1.0)):
        affinity = weight[chosen] / length[chosen]
        cohesive[chosen] = factor * length[chosen] * affinity**_EVENNESS
    return cohesive


def smooth_edges(surface: Surface, is_piece: BoolArray | None = None) -> SmoothEdges:
    """The dual edges inside flat and smoothly bent faces.

    An edge lies inside such a face if both its sides belong to one flat region, if both are pieces of divided faces
    and its dihedral angle is below 15 degrees, or if it belongs to the wall of a hole (``segcore.affinity.holes``). A
    flat region is a connected set of faces whose normals are within 1 degree of that of its largest face, with at least
    0.5 % of the area of its component and an outline along which the surface bends by 3 degrees on average: any small
    piece of a finely meshed round surface is as flat, but has no such outline.

    Parameters
    ----------
    is_piece : (F,) True for pieces of faces that were divided; None if there are none.
    """
    dihedral = dihedral_angles(surface)
    a, b = surface.edge_faces.T
    in_component = component_areas(surface)
    region = flat_regions(surface)
    regions = regions_of(surface, region, in_component)
    flat = ~regions.at_outline & _are_large(surface, regions, dihedral)[region[a]]
    wall = hole_walls(surface, dihedral, in_component)
    flat |= wall[a] & wall[b]
    if is_piece is None:
        return SmoothEdges(flat, np.zeros_like(flat), wall)
    smooth = (np.abs(dihedral) < _SMOOTH) & is_piece[a] & is_piece[b] & ~flat
    return SmoothEdges(flat | (smooth & (dihedral > -_FLAT)), smooth & (dihedral <= -_FLAT), wall)


def flat_regions(surface: Surface) -> IntArray:
    """(F,) the flat region 0, 1, ... of every face, grown from its largest face; most are single faces."""
    order = ascending(-surface.areas)
    return _grown(order, surface.face_graph().rows(), surface.normals, float(np.cos(_FLAT)))


def _are_large(surface: Surface, regions: Regions, dihedral: FloatArray) -> BoolArray:
    """(R,) True for the regions that are large beside their component and have a bent outline."""
    length = edge_lengths(surface)[regions.at_outline]
    bend = length * np.abs(dihedral[regions.at_outline])
    large: BoolArray = (regions.area >= _LEAST_SHARE * regions.of_component) & (
        regions.outline_sums(bend) >= _LEAST_BEND * regions.outline_sums(length)
    )
    return large


@kernel
def _grown(order: IntArray, rows: Rows, normals: FloatArray, cosine: float) -> IntArray:
    """(F,) regions grown breadth-first from the faces that have none yet, in an order (F,)."""
    region = np.full(len(order), -1, np.int32)
    queue = np.empty(len(order), np.int32)
    regions = 0
    for seed in order:
        if region[seed] >= 0:
            continue
        region[seed] = regions
        queue[0] = seed
        head, tail = 0, 1
        x, y, z = normals[seed, 0], normals[seed, 1], normals[seed, 2]
        while head < tail:
            f = queue[head]
            head += 1
            for p in range(rows.start[f], rows.start[f + 1]):
                g = rows.neighbour[p]
                if region[g] < 0 and x * normals[g, 0] + y * normals[g, 1] + z * normals[g, 2] >= cosine:
                    region[g] = regions
                    queue[tail] = g
                    tail += 1
        regions += 1
    return region
