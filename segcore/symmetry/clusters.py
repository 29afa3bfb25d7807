"""Clusters of a symmetric surface: those of one half, their mirror images, and a graph that is symmetric as well."""

from dataclasses import replace

import numpy as np

from segcore.arrays import BoolArray, IntArray, largest_options
from segcore.coarsen.clusters import Clusters, cluster_nodes, clusters_of
from segcore.graphs.mesh_graph import MeshGraph
from segcore.graphs.surface_graph import SurfaceGraph, connected_components
from segcore.graphs.tree import Tree
from segcore.progress import OnPart, report_nothing
from segcore.symmetry.images import MirrorImage
from segcore.symmetry.pieces import in_one_piece

# Affinity of an edge across which the image of a cluster does not continue: images of faces beside a crease can be on
# the wrong side of it, if the halves are meshed differently. Set by hand.
_CREASE = 0.1
# Fractions of the processor time of the stage "coarsen", measured on a dumbbell of 2,000,000 faces.
_HALF_CLUSTERED, CLUSTERED = 0.8, 0.98


def clusters_with_images(
    nodes: MeshGraph,
    mirror: MirrorImage | None,
    target: int,
    rng: np.random.Generator,
    on_part: OnPart = report_nothing,
) -> Clusters:
    """Coarsen a mesh graph to about ``target`` clusters, or not at all if it is 0; if it is symmetric, symmetrically.

    The first half is coarsened, and every face of the second half joins the image of the cluster of its image. Cluster
    i < N / 2 is in the first half, and its image is cluster i + N / 2. No cluster lies in both halves, unless a piece
    of one half is connected to the other half alone.

    Parameters
    ----------
    mirror : the mirror image of the surface, whose faces are the nodes; None if it is not symmetric.
    on_part : called with the fraction of the stage "coarsen" that is done.
    """
    if mirror is None:
        return cluster_nodes(nodes, target, rng)
    first = np.flatnonzero(mirror.is_first).astype(np.int32)
    half = MeshGraph(
        nodes.graph.subgraph(first),
        nodes.points[first],
        None,
        None if nodes.thickness is None else nodes.thickness[first],
        grain=None if nodes.grain is None else nodes.grain[first],
    )
    of_first = cluster_nodes(half, (target + 1) // 2, rng).of_node
    on_part(_HALF_CLUSTERED)
    of_node = _mirrored(nodes.graph, mirror, of_first)
    count = (int(of_node.max()) + 1) // 2
    image = np.roll(np.arange(2 * count, dtype=np.int32), count)
    return replace(clusters_of(nodes, of_node), image=image)


def symmetrised(clusters: Clusters, mirror: MirrorImage | None) -> Clusters:
    """Clusters with the means of their own graph and its image: weights, lengths, volumes, places and thickness.

    Clusters without images, of a surface that is not symmetric, are returned as they are.
    """
    image = clusters.image
    if mirror is None or image is None:
        return clusters
    graph, points, thickness = clusters.graph, clusters.points, clusters.thickness
    # Sums over an edge and its image have the same terms; the order of the two makes no difference.
    weight, length = (np.tile(0.5 * values, 2) for values in (graph.weight, graph.length))
    volume = 0.5 * (graph.volume + graph.volume[image])
    symmetric = SurfaceGraph.with_sums(np.concatenate([graph.edges, image[graph.edges]]), weight, volume, length)
    return replace(
        clusters,
        graph=symmetric,
        points=0.5 * (points + mirror.reflection.of_points(points[image])),
        thickness=None if thickness is None else 0.5 * (thickness + thickness[image]),
    )


def with_connected_leaves(tree: Tree, clusters: Clusters) -> Tree:
    """A tree over symmetric clusters with leaves that are connected in the graph before it was averaged.

    On a mesh that is not symmetric itself, a leaf can be connected by the image of an edge alone.
    """
    if clusters.image is None:
        return tree
    kind = np.zeros(2 * len(tree.split_node) + 1, dtype=np.int32)
    return replace(tree, leaf=in_one_piece(clusters.graph, tree.leaf, kind))


def _mirrored(graph: SurfaceGraph, mirror: MirrorImage, of_first: IntArray) -> IntArray:
    """(F,) clusters 0..C - 1 of the first half, and C..2 C - 1 of the second half, all connected and none empty.

    If a mesh is not symmetric itself, an image can be in several pieces or have no face. All pieces but the largest
    then join a neighbour, in the same half if there is one there. An image also comes apart at creases, unless its
    cluster has some. A cluster without an image joins a neighbour.

    Parameters
    ----------
    of_first : (F / 2,) the clusters of the faces of the first half.
    """
    first, second = np.flatnonzero(mirror.is_first), np.flatnonzero(~mirror.is_first)
    is_crease = graph.weight < _CREASE * graph.length
    while True:
        count = int(of_first.max()) + 1
        of_node = np.empty(graph.node_count, dtype=np.int32)
        of_node[first] = of_first
        of_node[second] = of_node[mirror.of_face[second]] + count
        half = np.repeat(np.arange(2, dtype=np.int32), count)
        smooth = _without_edges(graph, is_crease & ~_keeps_creases(graph, of_node, is_crease, count))
        of_node = in_one_piece(graph, in_one_piece(smooth, of_node, half), half)
        of_first = of_node[first]
        is_empty = np.bincount(of_node, minlength=2 * count)[count:] == 0
        if not is_empty.any():
            return in_one_piece(graph, of_node, np.zeros(2 * count, dtype=np.int32))
        of_first = _without_empty(graph, mirror, of_node, is_empty)


def _keeps_creases(graph: SurfaceGraph, of_node: IntArray, is_crease: BoolArray, count: int) -> BoolArray:
    """(E,) True for edges inside images of clusters that have creases themselves, and for those of the first half.

    Parameters
    ----------
    of_node : (F,) clusters 0..C - 1 of the first half, and their images C..2 C - 1.
    is_crease : (E,) whether the affinity of an edge is that of a crease.
    count : C.
    """
    one, other = of_node[graph.edges].T
    is_first = (one < count) & (other < count)
    has_crease = np.zeros(count, dtype=np.bool_)
    has_crease[one[is_first & is_crease & (one == other)]] = True
    return is_first | ((one == other) & has_crease[one % count])


def _without_edges(graph: SurfaceGraph, left_out: BoolArray) -> SurfaceGraph:
    kept = ~left_out
    return SurfaceGraph(graph.edges[kept], graph.weight[kept], graph.volume, graph.length[kept])


def _without_empty(graph: SurfaceGraph, mirror: MirrorImage, of_node: IntArray, is_empty: BoolArray) -> IntArray:
    """(F / 2,) clusters 0, 1, ... of the first half; those whose image is empty have joined a neighbour.

    Of several neighbours the one with the largest weight is taken, so that clusters do not continue across creases; if
    there is none, the one that has its place in the second half.
    """
    count = len(is_empty)
    ends = of_node[graph.edges]
    between = (ends < count).all(axis=1) & (ends[:, 0] != ends[:, 1])
    one, other = np.concatenate([ends[between], ends[between][:, ::-1]]).T
    first = np.flatnonzero(mirror.is_first)
    place = np.empty(count, dtype=np.int32)
    place[of_node[first][::-1]] = (of_node[mirror.of_face[first]] - count)[::-1]
    neighbour = largest_options(place, one, other, np.tile(graph.weight[between], 2))
    empty = np.flatnonzero(is_empty).astype(np.int32)
    joined = connected_components(np.stack([empty, neighbour[empty]], axis=1), count)
    return joined[of_node[first]]


def local_image(nodes: IntArray, image: IntArray) -> IntArray | None:
    """(M,) the places in ``nodes`` of their images; None if a set of nodes is not its own image.

    Parameters
    ----------
    nodes : (M,) ascending.
    image : (N,) the image of every node.
    """
    images = image[nodes]
    place = np.minimum(np.searchsorted(nodes, images), len(nodes) - 1)
    return place.astype(np.int32) if (nodes[place] == images).all() else None
