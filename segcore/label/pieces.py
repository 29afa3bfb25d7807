"""A tree over the pieces of divided faces, carried over to the whole faces."""

import numpy as np

from segcore.array_kernels import distinct_pairs, face_centroids
from segcore.arrays import at_least, group_sums, pair_keys
from segcore.clean.edge_geometry import edge_lengths
from segcore.clean.refinement import Refinement
from segcore.clean.surface import Surface
from segcore.coarsen.assembly import CONTACT
from segcore.coarsen.contacts import Links
from segcore.graphs.mesh_graph import MeshGraph
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.graphs.tree import Tree
from segcore.label.boundary import draw_boundaries
from segcore.label.projection import Votes, project
from segcore.symmetry.images import MirrorImage, mirror_image

_SHORTEST_EDGE = 1e-2  # least length of an edge in mean lengths, as in affinity/mesh_graphs.py


def draw_on_whole_faces(
    tree: Tree,
    pieces: MeshGraph,
    links: Links,
    refinement: Refinement,
    surface: Surface,
    mirror: MirrorImage | None = None,
) -> Tree:
    """The tree over the faces of a surface from one over the pieces of its refinement.

    The boundaries are drawn on the pieces first. Then, split by split, every face takes the side of most of its area,
    both sides are made connected, and the boundaries are drawn again between the faces.

    Parameters
    ----------
    pieces : the face dual graph of the refined surface.
    links : between components of the refined surface.
    mirror : the mirror image of the refined surface, if it is symmetric.
    """
    if refinement.surface is surface:
        return draw_boundaries(tree, pieces, links, surface, mirror)
    drawn = draw_boundaries(tree, pieces, links, refinement.surface, mirror)
    faces = whole_faces(pieces, refinement, surface)
    links = links_of_faces(links, pieces, refinement, surface)
    linked = faces.graph.with_edges(links.faces, CONTACT * links.length, links.length)
    number = np.arange(pieces.graph.node_count, dtype=np.int32)
    projected = project(drawn, Votes(refinement.parent, number, pieces.graph.volume), linked)
    return draw_boundaries(projected, faces, links, surface, mirror_image(surface) if mirror else None)


def links_of_faces(links: Links, pieces: MeshGraph, refinement: Refinement, surface: Surface) -> Links:
    """The links between whole faces: those of their pieces, and the edges of pieces whose faces have none.

    Patches can be stitched along more of their borders once these are divided.
    """
    of_pieces = refinement.parent[pieces.graph.edges]
    of_faces, pairs = (pair_keys(pairs, len(surface.faces)) for pairs in (surface.edge_faces, of_pieces))
    new = (of_pieces[:, 0] != of_pieces[:, 1]) & ~np.isin(pairs, of_faces)
    return Links(
        np.concatenate([refinement.parent[links.faces], of_pieces[new]]),
        np.concatenate([links.length, pieces.graph.length[new]]),
        np.concatenate([links.concavity, np.zeros(np.count_nonzero(new))]),
    )


def whole_faces(pieces: MeshGraph, refinement: Refinement, surface: Surface) -> MeshGraph:
    """The face dual graph of a surface; affinities are means over the edges of the pieces, weighted by length.

    Two faces that are joined along a gap may have pieces that are not; their affinity is the mean of all edges.
    """
    of_pieces = refinement.parent[pieces.graph.edges]
    different, which = distinct_pairs(np.concatenate([surface.edge_faces, of_pieces]))
    pair, pair_of_pieces = np.split(which, [len(surface.edge_faces)])
    weight = group_sums(pair_of_pieces, pieces.graph.weight, len(different))
    border = group_sums(pair_of_pieces, pieces.graph.length, len(different))
    affinity = np.full(len(different), pieces.graph.weight.sum() / pieces.graph.length.sum())
    np.divide(weight, border, out=affinity, where=border > 0.0)
    length = at_least(edge_lengths(surface), _SHORTEST_EDGE)
    volume = group_sums(refinement.parent, pieces.graph.volume)
    graph = SurfaceGraph(surface.edge_faces, length * affinity[pair], volume, length)
    return MeshGraph(graph, face_centroids(surface.vertices, surface.faces), None)
