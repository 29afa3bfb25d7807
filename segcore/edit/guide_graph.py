"""The weighted graph of a surface on which parts are corrected by hand."""

from dataclasses import dataclass

import numpy as np

from segcore.affinity.mesh_graphs import face_dual_graph
from segcore.array_kernels import distinct_pairs
from segcore.arrays import FloatArray, IntArray, at_least, group_sums
from segcore.clean.edge_geometry import edge_lengths
from segcore.clean.refinement import refine
from segcore.clean.surface import Surface
from segcore.coarsen.assembly import CONTACT, link_components
from segcore.coarsen.clusters import MOST_COMPONENTS
from segcore.coarsen.matching import coarsen
from segcore.graphs.mesh_graph import MeshGraph
from segcore.graphs.surface_graph import Rows, SurfaceGraph, connected_components
from segcore.label.boundary import STIFFNESS
from segcore.label.pieces import whole_faces
from segcore.parameters import SegmentationParameters

_SHORTEST = 1e-3  # least distance of two nodes, in mean distances; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class GuideGraph:
    """Faces of a surface, or connected clusters of them, as nodes; components that touch are connected.

    Lengths are in units of the surface.
    """

    edges: IntArray  # (E, 2)
    rows: Rows
    weight: FloatArray  # (E,) length times affinity
    length: FloatArray  # (E,) of the common border of two nodes
    cost: FloatArray  # (E,) of a border along every edge, as in :mod:`segcore.label.boundary`
    step: FloatArray  # (E,) distance between the centres of two nodes
    points: FloatArray  # (N, 3) the centres
    area: FloatArray  # (N,) > 0

    @classmethod
    def of(cls, graph: SurfaceGraph, points: FloatArray) -> "GuideGraph":
        """The nodes and edges of a graph whose volumes are areas."""
        away = np.linalg.norm(points[graph.edges[:, 0]] - points[graph.edges[:, 1]], axis=1)
        step = at_least(away, _SHORTEST)
        cost = graph.weight + STIFFNESS * graph.length
        return cls(graph.edges, graph.rows(), graph.weight, graph.length, cost, step, points, graph.volume)

    @property
    def resistance(self) -> FloatArray:
        """(E,) the length of a step between two nodes, longer across concavities: over the affinity plus 0.1."""
        affinity = self.weight / np.maximum(self.length, np.finfo(float).tiny)
        return self.step / (affinity + STIFFNESS)

    @property
    def count(self) -> int:
        """N, the number of nodes."""
        return len(self.area)


def face_guide_graph(surface: Surface) -> GuideGraph:
    """The faces of a surface with the default weights of the method, and links between components that touch."""
    refinement = refine(surface)
    nodes = face_dual_graph(refinement.surface, SegmentationParameters(), refinement.is_piece)
    if refinement.surface is not surface:
        nodes = whole_faces(nodes, refinement, surface)
    return GuideGraph.of(_linked(surface, nodes), nodes.points)


def _linked(surface: Surface, nodes: MeshGraph) -> SurfaceGraph:
    graph = nodes.graph
    component = connected_components(graph.edges, graph.node_count)
    links = link_components(surface, component, MOST_COMPONENTS)
    if len(links.faces) == 0:
        return SurfaceGraph(graph.edges, graph.weight, graph.volume, edge_lengths(surface))
    own = SurfaceGraph(graph.edges, graph.weight, graph.volume, edge_lengths(surface))
    return own.with_edges(links.faces, CONTACT * links.length, links.length)


@dataclass(frozen=True, slots=True, eq=False)
class GuideClusters:
    """Clusters of faces, none of which lies in two leaves of a hierarchy."""

    graph: GuideGraph
    of_face: IntArray  # (F,) the cluster of every face
    leaf: IntArray  # (N,) the leaf of every cluster


def guide_clusters(faces: GuideGraph, leaf: IntArray, most: int) -> GuideClusters:
    """About ``most`` clusters, or the faces themselves if there are no more.

    Parameters
    ----------
    leaf : (F,) the leaf of every face.
    """
    if faces.count <= most:
        return GuideClusters(faces, np.arange(faces.count, dtype=np.int32), leaf)
    graph = SurfaceGraph(faces.edges, faces.weight, faces.area, faces.length)
    _, cluster = coarsen(graph, most, np.random.default_rng(0))
    inside = (leaf[faces.edges[:, 0]] == leaf[faces.edges[:, 1]]) & (
        cluster[faces.edges[:, 0]] == cluster[faces.edges[:, 1]]
    )
    of_face = connected_components(faces.edges[inside], faces.count)
    area = group_sums(of_face, faces.area)
    points = np.stack([group_sums(of_face, faces.area * faces.points[:, axis]) / area for axis in range(3)], axis=1)
    ends = of_face[faces.edges[~inside]]
    across = ends[:, 0] != ends[:, 1]
    pairs, which = distinct_pairs(ends[across])
    weight, length = (group_sums(which, values[~inside][across], len(pairs)) for values in (faces.weight, faces.length))
    leaf_of_cluster = np.empty(len(area), dtype=np.int32)
    leaf_of_cluster[of_face] = leaf
    return GuideClusters(GuideGraph.of(SurfaceGraph(pairs, weight, area, length), points), of_face, leaf_of_cluster)
