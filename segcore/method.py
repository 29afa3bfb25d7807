"""Segmentation of a mesh into a hierarchy of parts: all stages in order."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from segcore.affinity.mesh_graphs import mesh_graph
from segcore.arrays import group_sums
from segcore.clean.refinement import Refinement, refine, undivided
from segcore.clean.surface import Surface, build_surface
from segcore.clean.voxels import without_voxel_steps
from segcore.coarsen.assembly import assemble
from segcore.coarsen.authored import with_structure
from segcore.coarsen.clusters import MOST_COMPONENTS, Clusters
from segcore.coarsen.contacts import Links
from segcore.coarsen.opposites import with_opposites
from segcore.cut.bisection import bisect
from segcore.cut.rules import SplitRule, split_rule
from segcore.cut.siblings import sibling_steps
from segcore.errors import InvalidParameters
from segcore.graphs.mesh_graph import MeshGraph
from segcore.graphs.tree import Tree
from segcore.hierarchy import Hierarchy
from segcore.label.pieces import draw_on_whole_faces
from segcore.label.projection import Votes, project
from segcore.mesh import Mesh
from segcore.parameters import SegmentationParameters
from segcore.progress import OnPart, OnProgress, Progress, report_nothing
from segcore.symmetry.clusters import CLUSTERED, clusters_with_images, symmetrised, with_connected_leaves
from segcore.symmetry.images import MirrorImage, mirror_image
from segcore.threads import default_threads, meanwhile, use_threads

_IMAGED = 0.6  # fraction of the processor time of the stage "coarsen", measured on a dumbbell of 2,000,000 faces


def segment(
    mesh: Mesh,
    parameters: SegmentationParameters | None = None,
    on_progress: OnProgress = lambda *_: None,
    surface: Surface | None = None,
    threads: int | None = None,
) -> Hierarchy:
    """Cut a mesh into a hierarchy of parts.

    Parameters
    ----------
    mesh : any triangle mesh. Open borders, non-manifold edges, duplicate and degenerate faces and several components
        are allowed.
    parameters : choices of the method, by default ``SegmentationParameters()``.
    on_progress : called with the name of a stage and the fraction of the whole work that is done, 0 to 1. An exception
        that it raises ends the segmentation and is passed on.
    surface : ``build_surface(mesh)``, if the caller has computed it already.
    threads : number of threads, which does not change the result; None for ``segcore.threads.default_threads``: one for
        a small mesh, the cores that are free for others. They start and end within the call.

    Returns
    -------
    The hierarchy of cuts, with a leaf for every face of the mesh in input order. The same mesh and parameters give the
    same hierarchy.

    Raises
    ------
    InvalidParameters
        If ``structure`` is one that the mesh does not have, or ``threads`` is not at least 1.
    """
    if threads is not None and threads < 1:
        raise InvalidParameters(f"The number of threads must be at least 1, not {threads}.")
    with use_threads(threads or default_threads(len(mesh.faces))):
        return _segment(mesh, parameters or SegmentationParameters(), Progress(on_progress, len(mesh.faces)), surface)


def _segment(mesh: Mesh, chosen: SegmentationParameters, progress: Progress, surface: Surface | None) -> Hierarchy:
    rng = np.random.default_rng(chosen.seed)
    progress("clean")
    surface = with_structure(surface or build_surface(mesh), mesh, chosen.structure)
    is_symmetric = chosen.is_symmetric and surface.authored is None
    shape = without_voxel_steps(surface) if chosen.measures_shape else surface
    coarse = coarse_graph(shape, chosen, rng, is_symmetric, progress)
    progress("cut")
    cut = partial(_tree, chosen, rng, partial(progress.after_splits, chosen.segment_limit))
    tree = with_connected_leaves(cut(coarse.symmetrised()), coarse.clusters)
    if coarse.clusters.image is not None and not tree.is_connected(coarse.clusters.graph):
        coarse = coarse.without_symmetry(chosen, rng)
        tree = cut(coarse)
    clusters = coarse.clusters
    tree = replace(tree, step=sibling_steps(clusters.graph, clusters.points, tree))
    progress("label")
    tree = _over_faces(tree, coarse, shape)
    hierarchy = _of_input(surface, tree)
    progress("label", 1.0)
    return hierarchy


@dataclass(frozen=True, slots=True, eq=False)
class CoarseGraph:
    """A surface with its large faces divided, the graph of its faces or vertices, and the clusters of these nodes."""

    refinement: Refinement
    nodes: MeshGraph
    mirror: MirrorImage | None  # None if the surface is not symmetric, or its symmetry is not used
    clusters: Clusters
    links: Links  # between the components of the surface

    def without_symmetry(self, parameters: SegmentationParameters, rng: np.random.Generator) -> "CoarseGraph":
        """Coarsen the same nodes again, without regard to the mirror image."""
        clusters, links = _coarsened(self.refinement.surface, self.nodes, None, parameters, rng)
        return replace(self, mirror=None, clusters=clusters, links=links)

    def symmetrised(self) -> "CoarseGraph":
        """Return the clusters with a graph that is symmetric as well, if they have images."""
        return replace(self, clusters=symmetrised(self.clusters, self.mirror))


def coarse_graph(
    surface: Surface,
    parameters: SegmentationParameters,
    rng: np.random.Generator,
    is_symmetric: bool,
    on_progress: OnProgress = lambda *_: None,
) -> CoarseGraph:
    """Carry out the stages "affinity" and "coarsen".

    Parameters
    ----------
    is_symmetric : look for a mirror symmetry of the surface, and coarsen both halves alike.
    on_progress : called with the name of each stage and the fraction of it that is done.
    """
    on_progress("affinity", 0.0)
    refinement = refine(surface) if parameters.measures_shape else undivided(surface)
    found = meanwhile(mirror_image, refinement.surface) if is_symmetric else lambda: None
    nodes = mesh_graph(refinement.surface, parameters, refinement.is_piece, partial(on_progress, "affinity"))
    on_part = partial(on_progress, "coarsen")
    on_part(0.0)
    mirror = found()
    on_part(_IMAGED)
    clusters, links = _coarsened(refinement.surface, nodes, mirror, parameters, rng, on_part)
    return CoarseGraph(refinement, nodes, mirror, clusters, links)


def _coarsened(
    surface: Surface,
    nodes: MeshGraph,
    mirror: MirrorImage | None,
    parameters: SegmentationParameters,
    rng: np.random.Generator,
    on_part: OnPart = report_nothing,
) -> tuple[Clusters, Links]:
    clusters = with_opposites(clusters_with_images(nodes, mirror, parameters.clusters, rng, on_part), nodes.opposites)
    on_part(CLUSTERED)
    return assemble(surface, nodes, clusters, parameters.max_segments or MOST_COMPONENTS)


def _tree(
    chosen: SegmentationParameters, rng: np.random.Generator, on_split: Callable[[float], None], coarse: CoarseGraph
) -> Tree:
    """Cut the graph of the clusters of a surface into a tree of segments."""
    rule = split_rule(coarse.refinement.surface, coarse.clusters, coarse.links, chosen, rng)
    return cut_by_rule(coarse.clusters, rule, chosen, on_split)


def cut_by_rule(
    clusters: Clusters,
    rule: SplitRule,
    chosen: SegmentationParameters,
    on_split: Callable[[float], None] = lambda _: None,
) -> Tree:
    """Cut the graph of some clusters into a tree of segments, by a rule."""
    return bisect(
        clusters.graph,
        clusters.points,
        rule,
        chosen.segment_limit,
        on_split,
        authored=clusters.authored,
        image=clusters.image,
        body=clusters.body,
        most_bodies=chosen.max_segments or MOST_COMPONENTS,
        only_sensible=chosen.ends_where_sensible,
    )


def _over_faces(tree: Tree, coarse: CoarseGraph, surface: Surface) -> Tree:
    """Carry a tree over the clusters over to the faces; if the nodes are the faces, draw its boundaries as well."""
    nodes, of_node = coarse.nodes, coarse.clusters.of_node
    if nodes.corners is None:
        tree = replace(tree, leaf=tree.leaf[of_node])
        return draw_on_whole_faces(tree, nodes, coarse.links, coarse.refinement, surface, coarse.mirror)
    linked = surface.face_graph().with_edges(coarse.links.faces, coarse.links.length, coarse.links.length)
    return project(tree, Votes.of_corners(of_node[nodes.corners]), linked)


def _of_input(surface: Surface, tree: Tree) -> Hierarchy:
    """Carry a tree over the faces of a surface to the input faces; sum areas and face counts from the leaves up."""
    leaf_of_input = tree.leaf[surface.face_of_input]
    nodes = 2 * len(tree.split_node) + 1
    area = group_sums(tree.leaf, surface.areas * surface.unit**2, nodes)
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
        step=tree.step,
        limit_reached=tree.limit_reached,
    )
