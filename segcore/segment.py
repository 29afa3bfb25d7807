"""The whole method on one screen."""

from collections.abc import Callable

import numpy as np

from segcore.affinity import concavity
from segcore.arrays import group_sums
from segcore.dual_graph import FaceClusters, cluster_faces, face_dual_graph
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh
from segcore.parameters import SegmentationParameters
from segcore.recursion import Tree, bisect
from segcore.surface import Surface, build_surface

Progress = Callable[[str, float], None]


def segment(
    mesh: Mesh, parameters: SegmentationParameters | None = None, on_progress: Progress = lambda *_: None
) -> Hierarchy:
    """Cut a mesh into a hierarchy of parts.

    Parameters
    ----------
    mesh : any triangle mesh; open borders, non-manifold edges, duplicate and degenerate faces and several components
        are segmented too.
    parameters : choices of the method, by default ``SegmentationParameters()``.
    on_progress : called with the name of a stage and the fraction of the whole work that is done, 0 to 1.

    Returns
    -------
    The hierarchy of cuts, with a label for every face of the mesh, in its order. The same mesh and parameters give the
    same hierarchy.
    """
    choices = parameters or SegmentationParameters()
    rng = np.random.default_rng(choices.seed)
    on_progress("clean", 0.0)
    surface = build_surface(mesh)
    on_progress("affinity", 0.25)
    affinity = concavity(surface)
    graph = face_dual_graph(surface, affinity)
    on_progress("coarsen", 0.45)
    clusters = cluster_faces(surface, graph, affinity, choices.clusters, choices.max_segments // 2, rng)
    on_progress("cut", 0.6)
    tree = bisect(
        clusters.graph, clusters.centroids, choices.max_segments, lambda done: on_progress("cut", 0.6 + 0.39 * done)
    )
    hierarchy = _hierarchy_of_input(surface, clusters, tree)
    on_progress("done", 1.0)
    return hierarchy


def _hierarchy_of_input(surface: Surface, clusters: FaceClusters, tree: Tree) -> Hierarchy:
    """Carry the tree over the clusters to the faces of the input, and sum up areas and faces from the leaves."""
    leaf_of_face = tree.leaf[clusters.of_face]
    leaf_of_input = leaf_of_face[surface.face_of_input]
    nodes = 2 * len(tree.split_node) + 1
    area = group_sums(leaf_of_face, surface.areas * surface.unit**2, nodes)
    face_count = np.bincount(leaf_of_input, minlength=nodes)
    for split in reversed(range(len(tree.split_node))):
        node = tree.split_node[split]
        area[node] = area[2 * split + 1] + area[2 * split + 2]
        face_count[node] = face_count[2 * split + 1] + face_count[2 * split + 2]
    return Hierarchy(
        split_node=tree.split_node,
        cut_value=tree.cut_value,
        area=area,
        face_count=face_count.astype(np.int32),
        face_leaf=leaf_of_input,
        automatic_segments=tree.automatic_segments,
    )
