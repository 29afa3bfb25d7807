"""A tree over the pieces of divided faces is carried over to the whole faces."""

import numpy as np

from segcore.arrays import FloatArray, IntArray, LongArray, group_sums
from segcore.clean.edge_geometry import edge_lengths
from segcore.clean.refinement import Refinement
from segcore.clean.surface import Surface
from segcore.coarsen.assembly import CONTACT
from segcore.coarsen.contacts import Links
from segcore.graphs.mesh_graph import MeshGraph
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.graphs.tree import Tree
from segcore.label.projection import Votes, project
from segcore.mesh import face_centroids


def whole_faces(pieces: MeshGraph, refinement: Refinement, surface: Surface) -> MeshGraph:
    """The face dual graph of a surface, with the mean affinity between the pieces of two faces as theirs.

    Parameters
    ----------
    pieces : the face dual graph of the refined surface.
    """
    parent, graph = refinement.parent, pieces.graph
    key = _pair_keys(parent[graph.edges])
    pair, which = np.unique(np.concatenate([key, _pair_keys(surface.edge_faces)]), return_inverse=True)
    count, at = len(pair), which[: len(key)]
    affinity = group_sums(at, graph.weight, count) / np.maximum(group_sums(at, graph.length, count), 1e-300)
    length = edge_lengths(surface)
    weight = np.maximum(length, 1e-300) * affinity[which[len(key) :]]
    volume = group_sums(parent, graph.volume)
    return MeshGraph(
        SurfaceGraph(surface.edge_faces, weight, volume, length), face_centroids(surface.vertices, surface.faces), None
    )


def of_whole_faces(tree: Tree, faces: MeshGraph, links: Links, refinement: Refinement, areas: FloatArray) -> Tree:
    """Give every face to the side of a split that has more of its area; both sides stay connected."""
    votes = Votes(refinement.parent, np.arange(len(refinement.parent), dtype=np.int32), areas)
    linked = faces.graph.with_edges(links.faces, CONTACT * links.length, links.length)
    return project(tree, votes, linked)


def links_of_faces(links: Links, refinement: Refinement) -> Links:
    """The links of pieces as links of their faces."""
    return Links(refinement.parent[links.faces], links.length)


def _pair_keys(pairs: IntArray) -> LongArray:
    low, high = pairs.min(axis=1).astype(np.int64), pairs.max(axis=1).astype(np.int64)
    key: LongArray = low << 32 | high
    return key
