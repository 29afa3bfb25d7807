"""Boundaries of the parts of a symmetric mesh, copied from one half to the other."""

import numpy as np

from segcore.arrays import IntArray
from segcore.graphs.surface_graph import SurfaceGraph, components_inside
from segcore.label.leaves import crossing_edges
from segcore.symmetry.images import MirrorImage
from segcore.symmetry.pieces import in_one_piece


def mirrored_places(place: IntArray, split_at: IntArray, graph: SurfaceGraph, mirror: MirrorImage) -> IntArray:
    """(F,) places of the faces, those of the second half copied from the first if both are meshed alike.

    Two leaves are images of each other if either has most of the image of the other. A face keeps its place if its leaf
    or that of its image is the image of none. Nothing is copied if a leaf or the boundary of a split would vanish.

    Parameters
    ----------
    place, split_at : as in :class:`segcore.label.leaves.Placement`.
    graph : the faces and their links.
    """
    if not mirror.meshed_alike:
        return place
    count = len(split_at)
    image = _images(place, mirror.of_face, count)
    source = place[mirror.of_face]
    copied = ~mirror.is_first & (image[source] >= 0) & (image[place] >= 0)
    proposed = np.where(copied, image[source], place).astype(np.int32)
    if np.array_equal(proposed, place):
        return place
    proposed = in_one_piece(graph, proposed, np.zeros(count, dtype=np.int32))
    pieces, pieces_before = (_pieces(graph, leaf) for leaf in (proposed, place))
    crossed, crossed_before = (_crossed(graph, leaf, split_at) for leaf in (proposed, place))
    is_whole = pieces <= pieces_before and len(np.unique(proposed)) == len(np.unique(place))
    return proposed if is_whole and np.array_equal(crossed, crossed_before) else place


def _images(place: IntArray, of_face: IntArray, count: int) -> IntArray:
    """(K,) the leaf that is the image of every leaf; -1 if there is none."""
    keys, faces = np.unique(place.astype(np.int64) * count + place[of_face], return_counts=True)
    ascending = np.argsort(faces, kind="stable")
    image = np.full(count, -1, dtype=np.int32)
    image[keys[ascending] // count] = keys[ascending] % count
    image[image[image] != np.arange(count)] = -1
    return image


def _pieces(graph: SurfaceGraph, place: IntArray) -> int:
    """The number of pieces of all leaves together."""
    return int(components_inside(graph.edges, place).max()) + 1


def _crossed(graph: SurfaceGraph, place: IntArray, split_at: IntArray) -> IntArray:
    """The splits that some edge crosses."""
    splits: IntArray = np.unique(crossing_edges(graph.edges, place, split_at)[1])
    return splits
