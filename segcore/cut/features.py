"""How many of the pairs that a cut parts people would have kept together: what a logistic model says of the cut.

The Rand index adds up over the splits of a hierarchy. So this one number says which of several cuts of a segment
is the best, which split is worth most, and which is worth nothing.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.graphs.cheeger import Cut
from segcore.graphs.surface_graph import SurfaceGraph

FEATURES = (
    "ncut",
    "ncc",
    "small_area",
    "large_area",
    "balance",
    "affinity",
    "affinity_contrast_small",
    "affinity_contrast_large",
    "border",
    "border_over_small",
    "border_over_large",
    "border_over_girth",
    "small_closed",
    "large_closed",
    "small_thickness",
    "large_thickness",
    "neck",
    "thickness_step",
    "small_thickness_spread",
    "large_thickness_spread",
    "small_flatness",
    "small_roundness",
    "large_flatness",
    "large_roundness",
    "depth",
    "parent_ncut",
    "against_parent",
)

_TINY = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class ClusterFields:
    """What the features of cuts are made from: the whole graph of clusters, where they are and how thick."""

    graph: SurfaceGraph
    points: FloatArray  # (N, 3)
    thickness: FloatArray  # (N,) logarithm of the shape diameter over sqrt(total area)
    degree: FloatArray  # (N,) total length of the edges of every cluster

    @classmethod
    def of(cls, graph: SurfaceGraph, points: FloatArray, thickness: FloatArray) -> "ClusterFields":
        degree = group_sums(graph.edges.ravel(), np.repeat(graph.length, 2), graph.node_count)
        return cls(graph, points, thickness, degree)


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """A connected set of nodes of the graph that is to be cut."""

    nodes: IntArray  # (M,) in the whole graph
    graph: SurfaceGraph  # the edges inside
    depth: int  # cuts above it, those between components left out
    parent_ncut: float  # normalized cut of the last of them; 0 where there is none


def cut_features(fields: ClusterFields, segment: Segment, cut: Cut) -> FloatArray:
    """(M,) the features of a cut of a segment, in the order of ``FEATURES``."""
    total = fields.graph.total_volume
    size = float(np.sqrt(total))
    graph, small = segment.graph, cut.side if cut.inside <= cut.outside else ~cut.side
    crossing = small[graph.edges[:, 0]] != small[graph.edges[:, 1]]
    border = float(graph.length[crossing].sum())
    one, other = _sides(fields, segment, small, border)
    affinity = cut.weight / border
    ends = graph.edges[crossing]
    at_cut = fields.thickness[segment.nodes[ends]].mean(axis=1)
    thickness = float(np.average(at_cut, weights=graph.length[crossing]))
    ncut = np.log(cut.ncut * size + _TINY)
    parent = np.log(segment.parent_ncut * size) if segment.parent_ncut > 0 else 0.0
    return np.array(
        [
            ncut,
            np.log(cut.ncc * size + _TINY),
            np.log(one.area / total),
            np.log(other.area / total),
            np.log(one.area / other.area),
            np.log(affinity),
            np.log(affinity / one.affinity),
            np.log(affinity / other.affinity),
            np.log(border / size),
            np.log(border / np.sqrt(one.area)),
            np.log(border / np.sqrt(other.area)),
            np.log(border / size) - thickness,
            one.closed,
            other.closed,
            one.thickness,
            other.thickness,
            thickness - min(one.thickness, other.thickness),
            abs(one.thickness - other.thickness),
            one.thickness_spread,
            other.thickness_spread,
            one.flatness,
            one.roundness,
            other.flatness,
            other.roundness,
            np.log1p(segment.depth),
            parent,
            ncut - parent if segment.parent_ncut > 0 else 0.0,
        ]
    )


@dataclass(frozen=True, slots=True)
class _Side:
    """One side of a cut."""

    area: float
    affinity: float  # mean over the borders inside
    closed: float  # share of its outline that is this cut
    thickness: float  # mean
    thickness_spread: float
    flatness: float  # least over largest standard deviation of the points
    roundness: float  # middle over largest


def _sides(fields: ClusterFields, segment: Segment, small: BoolArray, border: float) -> list[_Side]:
    graph, nodes = segment.graph, segment.nodes
    sums = _sums_of_sides(
        graph.edges,
        graph.weight,
        graph.length,
        graph.volume,
        small,
        fields.degree[nodes],
        fields.thickness[nodes],
        fields.points[nodes],
    )
    return [_side(row, border) for row in sums]


def _side(sums: FloatArray, border: float) -> _Side:
    area, weight, length, degree, thickness, squares = sums[:6].tolist()
    outline = degree - 2.0 * length
    mean = thickness / area
    centre = sums[6:9] / area
    variance = np.linalg.eigvalsh(sums[9:].reshape(3, 3) / area - np.outer(centre, centre))
    deviation = np.sqrt(np.maximum(variance, 0.0)) / np.sqrt(max(variance[2], _TINY))
    return _Side(
        area=area,
        affinity=weight / length if length > 0 else 1.0,
        closed=min(1.0, border / max(outline, border)),
        thickness=mean,
        thickness_spread=float(np.sqrt(max(squares / area - mean**2, 0.0))),
        flatness=float(deviation[0]),
        roundness=float(deviation[1]),
    )


@njit(cache=True)
def _sums_of_sides(edges, weight, length, volume, small, degree, thickness, points):  # type: ignore[no-untyped-def]
    """(2, 18) for the small side and the other: area; weight and length inside; and sums over the nodes of the degree,
    and, times the area, of thickness, its square, the position, and its products."""
    sums = np.zeros((2, 18))
    for e in range(len(edges)):
        a, b = edges[e, 0], edges[e, 1]
        if small[a] == small[b]:
            row = 0 if small[a] else 1
            sums[row, 1] += weight[e]
            sums[row, 2] += length[e]
    for i in range(len(volume)):
        row = 0 if small[i] else 1
        v, t, p = volume[i], thickness[i], points[i]
        sums[row, 0] += v
        sums[row, 3] += degree[i]
        sums[row, 4] += v * t
        sums[row, 5] += v * t * t
        for k in range(3):
            sums[row, 6 + k] += v * p[k]
            for m in range(3):
                sums[row, 9 + 3 * k + m] += v * p[k] * p[m]
    return sums
