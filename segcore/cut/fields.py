"""The clusters of a surface and a segment of them, with all that the features of a cut are made of."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.clean.edge_geometry import dihedral_angles, edge_lengths
from segcore.clean.surface import Surface
from segcore.coarsen.clusters import Clusters
from segcore.coarsen.contacts import Links
from segcore.cut.bodies import Bodies, pieces_of
from segcore.graphs.surface_graph import EdgeIndex, SurfaceGraph, induced_edges
from segcore.jit.decorators import kernel
from segcore.threads import in_blocks

_COPLANAR = np.deg2rad(1.0)  # largest dihedral angle of two faces of a plane; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class ClusterFields:
    """The graph of all clusters, and what is known about them."""

    graph: SurfaceGraph  # with the contacts between bodies
    points: FloatArray  # (N, 3)
    thickness: FloatArray  # (N,) logarithm of the shape diameter over sqrt(total area)
    confidence: FloatArray  # (N,) share of the rays of the thickness that met the other side from inside
    open_border: FloatArray  # (N,) length of the edges that have one face
    flat: FloatArray  # (E,) share of each edge of the graph that runs between coplanar faces
    concavity: FloatArray  # (E,) mean concavity of the contacts between bodies, see ``Links``; 0 for other edges
    degree: FloatArray  # (N,) total length of the edges of every cluster
    bodies: Bodies
    whole: "Whole"

    @classmethod
    def of(
        cls,
        graph: SurfaceGraph,
        points: FloatArray,
        thickness: FloatArray,
        *,
        body: IntArray | None = None,
        confidence: FloatArray | None = None,
        open_border: FloatArray | None = None,
        flat: FloatArray | None = None,
        concavity: FloatArray | None = None,
    ) -> "ClusterFields":
        """The fields of a graph; by default those of one closed body without flat faces."""
        count = graph.node_count
        of_cluster = np.zeros(count, dtype=np.int32) if body is None else body
        inside = of_cluster[graph.edges[:, 0]] == of_cluster[graph.edges[:, 1]]
        length = float(graph.length[inside].sum())
        affinity = float(graph.weight[inside].sum()) / length if length > 0.0 else 1.0
        bodies = Bodies.of(of_cluster, graph.volume, points)
        return cls(
            graph=graph,
            points=points,
            thickness=thickness,
            confidence=np.ones(count) if confidence is None else confidence,
            open_border=np.zeros(count) if open_border is None else open_border,
            flat=np.zeros(len(graph.edges)) if flat is None else flat,
            concavity=np.zeros(len(graph.edges)) if concavity is None else concavity,
            degree=group_sums(graph.edges.ravel(), np.repeat(graph.length, 2), count),
            bodies=bodies,
            whole=Whole(
                graph.total_volume, bodies.area, bodies.repeats, float(np.log(bodies.count)), float(np.log(affinity))
            ),
        )

    def inside(self, segment: "Segment") -> "SegmentFields":
        """The fields of a segment."""
        nodes, graph = segment.nodes, segment.graph
        body = self.bodies.of_cluster[nodes]
        edges = induced_edges(self.graph.edges, nodes, self.graph.node_count)[1]
        return SegmentFields(
            edges=graph.edges,
            weight=graph.weight,
            length=graph.length,
            flat=self.flat[edges],
            concavity=self.concavity[edges],
            volume=graph.volume,
            degree=self.degree[nodes],
            thickness=self.thickness[nodes],
            confidence=self.confidence[nodes],
            open_border=self.open_border[nodes],
            points=self.points[nodes],
            body=body,
            piece=pieces_of(graph, body),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """A connected set of nodes of the graph that is to be cut."""

    nodes: IntArray  # (M,) in the whole graph
    graph: SurfaceGraph  # the edges inside
    depth: int  # number of cuts above it, without the splits between components
    parent_ncut: float  # normalized cut of the last of them; 0 if there is none


class Whole(NamedTuple):
    """What the features of all cuts share, for compiled kernels."""

    total: float  # area
    body_area: FloatArray  # (B,)
    repeats: IntArray  # (B,) see ``Bodies``
    log_bodies: float  # logarithm of the number of bodies
    log_affinity: float  # logarithm of the mean affinity of the edges inside the bodies, weighted by length


class SegmentFields(NamedTuple):
    """The fields of the M nodes and E edges of a segment, for compiled kernels."""

    edges: IntArray  # (E, 2)
    weight: FloatArray  # (E,)
    length: FloatArray  # (E,)
    flat: FloatArray  # (E,)
    concavity: FloatArray  # (E,)
    volume: FloatArray  # (M,)
    degree: FloatArray  # (M,) in the whole graph
    thickness: FloatArray  # (M,)
    confidence: FloatArray  # (M,)
    open_border: FloatArray  # (M,)
    points: FloatArray  # (M, 3)
    body: IntArray  # (M,)
    piece: IntArray  # (M,) see ``segcore.cut.bodies.pieces_of``


def cluster_fields(surface: Surface, clusters: Clusters, links: Links) -> ClusterFields:
    """The fields of clusters of the faces of a surface, whose thickness was measured.

    Parameters
    ----------
    links : between the components of the surface.
    """
    assert clusters.thickness is not None
    count = clusters.graph.node_count
    length = edge_lengths(surface)
    index = EdgeIndex.of(clusters.graph)
    return ClusterFields.of(
        clusters.graph,
        clusters.points,
        clusters.thickness,
        body=clusters.body,
        confidence=clusters.confidence,
        open_border=group_sums(clusters.of_node, _open_border(surface, length), count),
        flat=_flat_share(surface, length, clusters, index),
        concavity=_means_on_edges(index, clusters.of_node[links.faces], links.length, links.concavity),
    )


def _open_border(surface: Surface, length: FloatArray) -> FloatArray:
    """(F,) the length of the edges of every face that no other face shares."""
    perimeter = np.empty(len(surface.faces))
    in_blocks(_write_perimeters, len(perimeter), surface.vertices, surface.faces, perimeter)
    shared = _sums_at_ends(surface.edge_faces, length, len(perimeter))
    rounding = 1e-9 * perimeter
    return np.where(perimeter - shared > rounding, np.maximum(perimeter - shared, 0.0), 0.0)


@kernel
def _write_perimeters(start, end, vertices, faces, perimeter):  # type: ignore[no-untyped-def]
    for f in range(start, end):
        perimeter[f] = 0.0
        for k in range(3):
            p, q = vertices[faces[f, k]], vertices[faces[f, (k + 1) % 3]]
            perimeter[f] += np.sqrt((q[0] - p[0]) ** 2 + (q[1] - p[1]) ** 2 + (q[2] - p[2]) ** 2)


@kernel
def _sums_at_ends(edges: IntArray, values: FloatArray, count: int) -> FloatArray:
    """(count,) the sum of the values (E,) of the edges (E, 2) at every node."""
    sums = np.zeros(count)
    for e in range(len(edges)):
        sums[edges[e, 0]] += values[e]
        sums[edges[e, 1]] += values[e]
    return sums


def _flat_share(surface: Surface, length: FloatArray, clusters: Clusters, index: EdgeIndex) -> FloatArray:
    """(E,) the share of each edge of the graph of the clusters that runs between coplanar faces."""
    ends = clusters.of_node[surface.edge_faces]
    crossing = np.flatnonzero(ends[:, 0] != ends[:, 1])
    is_flat = np.abs(dihedral_angles(surface, crossing)) < _COPLANAR
    return _means_on_edges(index, ends[crossing], length[crossing], is_flat)


def _means_on_edges(index: EdgeIndex, ends: IntArray, length: FloatArray, values: FloatArray | BoolArray) -> FloatArray:
    """(E,) the means on the edges of a graph of values (B,) of borders between its nodes (B, 2), weighted by length.

    Borders that are no edge of the graph do not count: a graph that was made symmetric can lack some. An edge without
    borders has 0.
    """
    edge = index.find(ends)
    known = edge >= 0
    edge, length, values = edge[known], length[known], values[known]
    total = group_sums(edge, length, len(index.edge))
    weighted = group_sums(edge, length * values, len(index.edge))
    means: FloatArray = np.divide(weighted, total, out=np.zeros(len(total)), where=total > 0.0)
    return means
