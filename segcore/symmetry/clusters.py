"""Clusters of a symmetric surface: those of one half, their mirror images, and a graph that is symmetric as well."""

from dataclasses import replace

import numpy as np

from segcore.arrays import BoolArray, IntArray, group_sums
from segcore.coarsen.clusters import Clusters, cluster_nodes, clusters_of
from segcore.graphs.mesh_graph import MeshGraph
from segcore.graphs.surface_graph import SurfaceGraph, connected_components
from segcore.symmetry.images import MirrorImage
from segcore.symmetry.pieces import in_one_piece

_ATTEMPTS = 8  # at clusters whose symmetric graph is connected if the surface is; set by hand


def clusters_with_images(
    nodes: MeshGraph, mirror: MirrorImage | None, target: int, rng: np.random.Generator
) -> Clusters:
    """Coarsen a mesh graph to about ``target`` clusters, or not at all if it is 0; if it is symmetric, symmetrically.

    The first half is coarsened, and every face of the second half joins the image of the cluster of its image. Cluster
    i < N / 2 is in the first half, and its image is cluster i + N / 2. Two clusters are neighbours in the graph only if
    their images are. If this divides a component, the clusters of its smaller pieces are merged with neighbours; if
    pieces remain, the clusters are those of a surface without symmetry.

    Parameters
    ----------
    mirror : the mirror image of the surface, whose faces are the nodes; None if it is not symmetric.
    """
    if mirror is None:
        return cluster_nodes(nodes, target, rng)
    first = np.flatnonzero(mirror.is_first).astype(np.int32)
    half = MeshGraph(
        nodes.graph.subgraph(first),
        nodes.points[first],
        None,
        None if nodes.thickness is None else nodes.thickness[first],
    )
    of_first = cluster_nodes(half, (target + 1) // 2, rng).of_node
    for _ in range(_ATTEMPTS):
        of_node = _mirrored(nodes.graph, mirror, of_first)
        count = (int(of_node.max()) + 1) // 2
        image = np.roll(np.arange(2 * count, dtype=np.int32), count)
        clusters = clusters_of(nodes, of_node)
        symmetric = _averaged(replace(clusters, image=image), image, mirror, least=2)
        is_apart = _apart(symmetric.graph, clusters.graph)
        if not is_apart.any():
            return symmetric
        into = _nearest_part(clusters.graph, is_apart | is_apart[image], count)
        of_first = np.unique(into[of_node[first] % count], return_inverse=True)[1].astype(np.int32)
    return cluster_nodes(nodes, target, rng)


def symmetrised(clusters: Clusters, mirror: MirrorImage | None) -> Clusters:
    """Clusters whose links between components are symmetric as well: the means of the graph and its image.

    Clusters without images, of a surface that is not symmetric, are returned as they are.
    """
    if mirror is None or clusters.image is None:
        return clusters
    return _averaged(clusters, clusters.image, mirror, least=1)


def _apart(graph: SurfaceGraph, whole: SurfaceGraph) -> BoolArray:
    """(N,) True for the nodes outside the largest piece of their component.

    Parameters
    ----------
    whole : the graph of the components; ``graph`` has some of its edges.
    """
    piece = connected_components(graph.edges, graph.node_count)
    component = connected_components(whole.edges, whole.node_count)
    volume = group_sums(piece, graph.volume)
    ascending = np.argsort(volume[piece], kind="stable")
    largest = np.empty(int(component.max()) + 1, dtype=np.int32)
    largest[component[ascending]] = piece[ascending]
    is_apart: BoolArray = piece != largest[component]
    return is_apart


def _nearest_part(graph: SurfaceGraph, is_apart: BoolArray, count: int) -> IntArray:
    """(C,) for every cluster of the first half that is apart the neighbour with the longest border, else the cluster.

    Parameters
    ----------
    is_apart : (2 C,) for every cluster.
    count : C; the neighbour is in the first half too, and not apart.
    """
    one, other = np.concatenate([graph.edges, graph.edges[:, ::-1]]).T
    length = np.tile(graph.length, 2)
    joins = (one < count) & (other < count) & is_apart[one] & ~is_apart[other]
    ascending = np.flatnonzero(joins)[np.argsort(length[joins], kind="stable")]
    into = np.arange(count, dtype=np.int32)
    into[one[ascending]] = other[ascending]
    return into


def _averaged(clusters: Clusters, image: IntArray, mirror: MirrorImage, least: int) -> Clusters:
    """Clusters with the means of their own values and those of their images: weights, lengths, volumes, places.

    Parameters
    ----------
    least : 2 if an edge without an image is left out, 1 if it gets an image and both have half of its weight.
    """
    graph, points, thickness = clusters.graph, clusters.points, clusters.thickness
    count = graph.node_count
    both = np.concatenate([graph.edges, image[graph.edges]]).astype(np.int64)
    keys, which = np.unique(both.min(axis=1) * count + both.max(axis=1), return_inverse=True)
    # Sums over an edge and its image have the same terms; the order of the two makes no difference.
    weight, length = (0.5 * group_sums(which, np.tile(values, 2)) for values in (graph.weight, graph.length))
    kept = np.bincount(which) >= least
    edges = np.stack([keys // count, keys % count], axis=1).astype(np.int32)[kept]
    symmetric = SurfaceGraph(edges, weight[kept], 0.5 * (graph.volume + graph.volume[image]), length[kept])
    return replace(
        clusters,
        graph=symmetric,
        points=0.5 * (points + mirror.reflection.of_points(points[image])),
        thickness=None if thickness is None else 0.5 * (thickness + thickness[image]),
    )


def _mirrored(graph: SurfaceGraph, mirror: MirrorImage, of_first: IntArray) -> IntArray:
    """(F,) clusters 0..C - 1 of the first half, and C..2 C - 1 of the second half, all connected and none empty.

    If a mesh is not symmetric itself, an image can be in several pieces or have no face. All pieces but the largest
    then join a neighbour, in the same half if there is one there, and a cluster without an image joins the one that has
    its place in the second half.

    Parameters
    ----------
    of_first : (F / 2,) the clusters of the faces of the first half.
    """
    first, second = np.flatnonzero(mirror.is_first), np.flatnonzero(~mirror.is_first)
    while True:
        count = int(of_first.max()) + 1
        of_node = np.empty(graph.node_count, dtype=np.int32)
        of_node[first] = of_first
        of_node[second] = of_node[mirror.of_face[second]] + count
        of_node = in_one_piece(graph, of_node, np.repeat(np.arange(2, dtype=np.int32), count))
        of_first = of_node[first]
        is_empty = np.bincount(of_node, minlength=2 * count)[count:] == 0
        if not is_empty.any():
            return in_one_piece(graph, of_node, np.zeros(2 * count, dtype=np.int32))
        joined = np.arange(count, dtype=np.int32)
        place = of_node[mirror.of_face[first]] - count
        joined[of_first[::-1]] = np.where(is_empty[of_first], place, of_first)[::-1]
        of_first = np.unique(joined[of_first], return_inverse=True)[1].astype(np.int32)


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
