"""Flat regions of a surface and smooth strips: a cut that is not at a crease should go around them."""

import numpy as np
from numba import njit

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.clean.edge_geometry import dihedral_angles, edge_lengths
from segcore.clean.surface import Surface
from segcore.graphs.surface_graph import connected_components

COHESION = 4.0
_TOLERANCE = np.deg2rad(1.0)
_SMOOTH = np.deg2rad(15.0)
_LEAST_SHARE = 0.005
_LEAST_CREASE = np.deg2rad(3.0)


import os
_B, _K = map(float, os.environ.get("FLAT", "4,0.5").split(","))
def cohesion(surface, weight, length, is_piece):
    flat = is_flat_edge(surface, is_piece)
    w = weight.copy()
    g = weight[flat] / length[flat]
    w[flat] = length[flat] * _B * g ** _K
    return w

def is_flat_edge(surface: Surface, piece) -> BoolArray:
    a, b = surface.edge_faces.T
    dihedral = dihedral_angles(surface)
    region = flat_regions(surface)
    large = _is_large(surface, region, dihedral)
    inside = (region[a] == region[b]) & large[region[a]]
    if piece is None:
        return inside
    smooth = (dihedral > -_TOLERANCE) & (dihedral < _SMOOTH) & piece[a] & piece[b]
    return inside | smooth


def _is_large(surface: Surface, region: IntArray, dihedral: FloatArray) -> BoolArray:
    count = int(region.max()) + 1
    component = connected_components(surface.edge_faces, len(surface.faces))
    whole = group_sums(component, surface.areas)
    of_region = np.zeros(count)
    of_region[region] = whole[component]
    area = group_sums(region, surface.areas, count)
    a, b = region[surface.edge_faces].T
    border = a != b
    length = edge_lengths(surface)[border]
    bent = length * np.abs(dihedral[border])
    total = group_sums(a[border], length, count) + group_sums(b[border], length, count)
    crease = group_sums(a[border], bent, count) + group_sums(b[border], bent, count)
    return (area >= _LEAST_SHARE * of_region) & (crease >= _LEAST_CREASE * total)


def flat_regions(surface: Surface) -> IntArray:
    order = np.argsort(-surface.areas, kind="stable")
    rows = surface.face_graph().rows()
    return _regions(order, rows.start, rows.neighbour, surface.normals, float(np.cos(_TOLERANCE)))


@njit(cache=True)
def _regions(order, start, neighbour, normals, cosine):  # type: ignore[no-untyped-def]
    count = len(order)
    region = np.full(count, -1, np.int32)
    queue = np.empty(count, np.int32)
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
            for p in range(start[f], start[f + 1]):
                g = neighbour[p]
                if region[g] < 0 and x * normals[g, 0] + y * normals[g, 1] + z * normals[g, 2] >= cosine:
                    region[g] = regions
                    queue[tail] = g
                    tail += 1
        regions += 1
    return region
