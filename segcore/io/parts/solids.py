"""Closed surfaces as solids: vertices between fans of faces are divided, pieces that are inside out are turned."""

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray, group_sums, pair_keys
from segcore.graphs.surface_graph import connected_components

_LARGEST = 64  # pieces that are tested for holding others, the largest; set by hand
_NEXT = np.array([1, 1, -2])  # from a corner of a face to the next one, if corners are numbered 3 f + k


def divided_vertices(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """The same faces with a vertex of its own, at the same position, for every fan of faces around a vertex.

    A fan consists of faces around a vertex that are connected by edges. If an edge has more than two faces, those are
    connected that enclose a solid.
    """
    one, other = _opposite_edges(vertices, faces).T
    ends = one + _NEXT[one % 3], other + _NEXT[other % 3]
    same = np.stack([np.concatenate([one, ends[0]]), np.concatenate([ends[1], other])], axis=1)
    fan = connected_components(same.astype(np.int32), faces.size)
    vertex_of_fan = faces.reshape(-1)[np.unique(fan, return_index=True)[1]]
    order = np.argsort(vertex_of_fan, kind="stable")
    place = np.empty(len(order), dtype=np.int32)
    place[order] = np.arange(len(order), dtype=np.int32)
    return vertices[vertex_of_fan[order]], place[fan].reshape(-1, 3)


def is_manifold(faces: IntArray) -> bool:
    """Whether each edge has two faces, which run through it in opposite directions."""
    ends = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64)
    count = int(faces.max()) + 1
    forward, backward = (np.sort(ends[:, k] * count + ends[:, 1 - k]) for k in (0, 1))
    return bool((forward[1:] > forward[:-1]).all() and (forward == backward).all())


def _opposite_edges(vertices: FloatArray, faces: IntArray) -> LongArray:
    """(P, 2) pairs of half-edges, 3 f + k from corner k of face f, that run through one edge in opposite directions."""
    ends = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    keys = pair_keys(ends, len(vertices))
    order = np.argsort(keys, kind="stable")
    first = np.flatnonzero(np.diff(keys[order], prepend=-1))
    size = np.diff(first, append=len(keys))
    pairs = np.stack([order[first[size == 2]], order[first[size == 2] + 1]], axis=1)
    pairs = pairs[ends[pairs[:, 0], 0] != ends[pairs[:, 1], 0]]
    crowded = [
        pair
        for start, count in zip(first[size > 2].tolist(), size[size > 2].tolist(), strict=True)
        for pair in _around_an_edge(vertices, faces, order[start : start + count])
    ]
    return np.concatenate([pairs, np.array(crowded, dtype=np.int64).reshape(-1, 2)])


def _around_an_edge(vertices: FloatArray, faces: IntArray, half_edges: LongArray) -> list[tuple[int, int]]:
    """Pair each half-edge with the next one in the opposite direction, turning from its face to the inside."""
    corners = faces[half_edges // 3, half_edges % 3]
    ends = faces.reshape(-1)[half_edges + _NEXT[half_edges % 3]]
    apex = vertices[faces.reshape(-1)[half_edges - _NEXT[(half_edges - 1) % 3]]]
    low, high = min(corners[0], ends[0]), max(corners[0], ends[0])
    along = vertices[high] - vertices[low]
    across = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    towards = apex - vertices[low]
    angle = -np.arctan2(towards @ np.cross(along, across), towards @ across * np.linalg.norm(along))
    turn = half_edges[np.argsort(angle, kind="stable")].tolist()
    is_forward = dict(zip(half_edges.tolist(), (corners == low).tolist(), strict=True))
    waiting: list[int] = []
    pairs: list[tuple[int, int]] = []
    paired: set[int] = set()
    for half_edge in turn + turn:  # twice, because the turn may begin within a solid
        if half_edge in paired:
            continue
        if is_forward[half_edge]:
            waiting = [*(edge for edge in waiting if edge != half_edge), half_edge]
        elif waiting:
            pairs.append((waiting[-1], half_edge))
            paired |= {waiting.pop(), half_edge}
    return pairs


def outward(vertices: FloatArray, faces: IntArray, is_cap: BoolArray) -> IntArray:
    """The faces, those of pieces with a cap that are inside out turned, unless they lie within another piece.

    The surface of a dent alone, closed by a cap, encloses a negative volume. So does a cavity that was cut, but it lies
    within another piece.

    Parameters
    ----------
    is_cap : (F,) True for the faces of caps.
    """
    ends = faces[:, [[0, 1], [1, 2]]].reshape(-1, 2)
    piece = connected_components(ends, len(vertices))[faces[:, 0]]
    corners = vertices[faces] - vertices.mean(axis=0)
    volume = group_sums(piece, np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0)
    suspects = np.flatnonzero((volume < 0) & (group_sums(piece, is_cap.astype(np.float64)) > 0))
    if len(suspects) == 0:
        return faces
    low, high = (np.full((len(volume), 3), bound) for bound in (np.inf, -np.inf))
    for corner in faces.T:
        np.minimum.at(low, piece, vertices[corner])
        np.maximum.at(high, piece, vertices[corner])
    extent = np.where(volume > 0, (high - low).max(axis=1), 0.0)
    around = np.argsort(-extent, kind="stable")[:_LARGEST]
    around = around[volume[around] > 0]
    holds = (low[around] < low[suspects, None]) & (high[around] > high[suspects, None])
    is_held: BoolArray = np.any(np.all(holds, axis=2), axis=1)
    is_turned = np.isin(piece, suspects[~is_held])
    return np.where(is_turned[:, None], faces[:, ::-1], faces)
