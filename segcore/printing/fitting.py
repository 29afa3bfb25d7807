"""Parts that are larger than the bed, divided by the next splits of the hierarchy."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.hierarchy import Hierarchy

_MOST_PIECES = 8  # of one part; set by hand: more splits than that make more borders than planes do


@dataclass(frozen=True, slots=True, eq=False)
class FittedLevel:
    """A level of which some parts are divided into pieces."""

    labels: IntArray  # (F,) the piece of every input face
    part: list[int]  # the part of every piece, by its label at the level

    def number(self, piece: int) -> int:
        """The number of a piece among those of its part, from 1."""
        return piece - self.part.index(self.part[piece]) + 1


def fitted_level(hierarchy: Hierarchy, segments: int | None, corners: FloatArray, room: FloatArray) -> FittedLevel:
    """Divide the parts of a level whose boxes are larger than a room, if further splits make pieces that all fit.

    A part that would need more than 8 pieces, or that no splits make small enough, stays whole.

    Parameters
    ----------
    corners : (F, 3, 3) of the input faces.
    room : (3,) the sides of the largest box that fits.
    """
    size = _sizes(hierarchy, corners)
    child = np.full(hierarchy.node_count, -1)
    child[hierarchy.split_node] = 2 * np.arange(len(hierarchy.split_node)) + 1
    nodes: list[int] = []
    part: list[int] = []
    for label, node in enumerate(hierarchy.segment_nodes(segments).tolist()):
        pieces = _fitting(node, size > room, child) or [node]
        nodes += pieces
        part += [label] * len(pieces)
    piece = np.full(hierarchy.node_count, -1, dtype=np.int32)
    piece[nodes] = np.arange(len(nodes))
    for split, node in enumerate(hierarchy.split_node.tolist()):  # a node is split after the split that makes it
        if piece[node] >= 0:
            piece[2 * split + 1 : 2 * split + 3] = piece[node]
    return FittedLevel(piece[hierarchy.face_leaf], part)


def _sizes(hierarchy: Hierarchy, corners: FloatArray) -> FloatArray:
    """(nodes, 3) the sides of the box of every node; minus infinity for a node without faces."""
    low, high = (np.full((hierarchy.node_count, 3), bound) for bound in (np.inf, -np.inf))
    np.minimum.at(low, hierarchy.face_leaf, corners.min(axis=1))
    np.maximum.at(high, hierarchy.face_leaf, corners.max(axis=1))
    for split in range(len(hierarchy.split_node) - 1, -1, -1):
        node, halves = hierarchy.split_node[split], slice(2 * split + 1, 2 * split + 3)
        low[node], high[node] = low[halves].min(axis=0), high[halves].max(axis=0)
    return high - low


def _fitting(node: int, is_large: np.ndarray, child: IntArray) -> list[int] | None:
    """The nodes below a node that fit, in the order of the tree; None if there are too many or one does not fit."""
    found: list[int] = []
    waiting = [node]
    while waiting:
        node = waiting.pop()
        if not is_large[node].any():
            found.append(node)
        elif child[node] < 0:
            return None
        else:
            waiting += [int(child[node]) + 1, int(child[node])]
        if len(found) + len(waiting) > _MOST_PIECES:
            return None
    return found
