"""Best-first bisection: which segment is split next, where, and when to stop."""

from collections.abc import Callable
from dataclasses import dataclass
from heapq import heappop, heappush

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.cheeger import Cut, cut_of
from segcore.components import group_by_nearness
from segcore.graph import SurfaceGraph, connected_components
from segcore.parameters import SegmentationParameters
from segcore.solvers import SOLVERS

# The normalized cut times sqrt(total area) from which people no longer cut, on the odd-numbered benchmark models.
AUTOMATIC_NCUT = 1.47
_SMALLEST_SIDE = 0.002  # share of the total area below which a part is cut off only after everything else


@dataclass(frozen=True, slots=True, eq=False)
class Tree:
    """The splits of the nodes of a graph, numbered as in :class:`segcore.hierarchy.Hierarchy`."""

    split_node: IntArray  # (S,)
    cut_value: FloatArray  # (S,) normalized cut times sqrt(total volume); 0 where components part
    leaf: IntArray  # (N,) the leaf of every node of the graph
    automatic_segments: int


@dataclass(frozen=True, slots=True, eq=False)
class _Segment:
    """A connected set of nodes of the graph that is to be cut."""

    nodes: IntArray  # (M,) in the graph that is cut
    graph: SurfaceGraph  # the edges inside


@dataclass(frozen=True, slots=True, eq=False)
class _Candidate:
    """The best cut of a segment; ``late`` where it parts off so little that it waits for everything else."""

    cut: Cut
    value: float
    late: bool


def bisect(
    graph: SurfaceGraph,
    points: FloatArray,
    parameters: SegmentationParameters,
    rng: np.random.Generator,
    on_split: Callable[[float], None] = lambda _: None,
) -> Tree:
    """Part the components of a graph, then cut the segment with the least normalized cut again and again.

    Parameters
    ----------
    points : (N, 3) positions of the nodes, for the nearness of components.
    parameters : ``max_segments`` says where to stop (components are parted in any case), ``order`` which segment is
        next, ``solver`` how a segment is cut.
    rng : for the solvers with random starts.
    on_split : called with the fraction of ``max_segments`` that is reached.

    Notes
    -----
    Volumes stay those of the whole graph. Every cut is made to have two connected sides. A cut whose smaller side has
    less than 0.2 % of the total volume is made after all others.
    """
    component = connected_components(graph)
    tree = _GrowingTree(graph, parameters, rng)
    for node, members in tree.part_components(component, group_by_nearness(points, component)):
        tree.add(node, _Segment(members, graph.subgraph(members)))
    while tree.segments < parameters.max_segments and tree.split_next():
        on_split(tree.segments / parameters.max_segments)
    return tree.finished()


class _GrowingTree:
    """The state of a best-first bisection."""

    def __init__(self, graph: SurfaceGraph, parameters: SegmentationParameters, rng: np.random.Generator) -> None:
        self._parameters = parameters
        self._rng = rng
        self._volume = graph.volume
        self._total = graph.total_volume
        self._split_node: list[int] = []
        self._cut_value: list[float] = []
        self._automatic: int | None = None
        self._queue: list[tuple[bool, float, int]] = []
        self._segments: dict[int, _Segment] = {}
        self._candidates: dict[int, _Candidate] = {}
        self._leaf = np.zeros(graph.node_count, dtype=np.int32)

    @property
    def segments(self) -> int:
        return len(self._split_node) + 1

    def part_components(self, component: IntArray, merges: IntArray) -> list[tuple[int, IntArray]]:
        """Undo the merges of components from the last to the first; the components and their nodes in the tree."""
        count = len(merges) + 1
        volume = np.zeros(2 * count - 1)
        volume[:count] = group_sums(component, self._volume, count)
        for i, (a, b) in enumerate(merges.tolist()):
            volume[count + i] = volume[a] + volume[b]
        node_of_group = np.zeros(2 * count - 1, dtype=np.int32)
        for i, (a, b) in reversed(list(enumerate(merges.tolist()))):
            larger, smaller = (a, b) if volume[a] >= volume[b] else (b, a)
            node_of_group[larger], node_of_group[smaller] = self._split(int(node_of_group[count + i]), 0.0)
        members = np.split(np.argsort(component, kind="stable"), np.cumsum(np.bincount(component))[:-1])
        return [(int(node_of_group[c]), members[c].astype(np.int32)) for c in range(count)]

    def add(self, node: int, segment: _Segment) -> None:
        """A new segment: find its best cut now, or later where that can only be a late one."""
        self._segments[node] = segment
        self._leaf[segment.nodes] = node
        volume = segment.graph.total_volume
        if len(segment.nodes) == 1:
            return
        if volume >= 2 * _SMALLEST_SIDE * self._total:
            self._candidates[node] = self._best_cut(segment.graph)
            if not self._candidates[node].late:
                heappush(
                    self._queue,
                    (False, -volume if self._parameters.order == "volume" else self._candidates[node].value, node),
                )
                return
        heappush(self._queue, (True, -volume, node))

    def split_next(self) -> bool:
        """Make the next split; False where every segment is a single node."""
        if not self._queue:
            return False
        late, _, node = heappop(self._queue)
        segment = self._segments.pop(node)
        candidate = self._candidates.pop(node, None) or self._best_cut(segment.graph)
        if self._automatic is None and (late or candidate.cut.ncut * np.sqrt(self._total) >= AUTOMATIC_NCUT):
            self._automatic = self.segments
        larger, smaller = self._split(node, candidate.value)
        inside_larger = candidate.cut.side == (candidate.cut.inside >= candidate.cut.outside)
        self.add(larger, _part(segment, inside_larger))
        self.add(smaller, _part(segment, ~inside_larger))
        return True

    def finished(self) -> Tree:
        return Tree(
            split_node=np.array(self._split_node, dtype=np.int32),
            cut_value=np.array(self._cut_value),
            leaf=self._leaf,
            automatic_segments=self._automatic or self.segments,
        )

    def _split(self, node: int, value: float) -> tuple[int, int]:
        self._split_node.append(node)
        self._cut_value.append(value)
        return 2 * len(self._split_node) - 1, 2 * len(self._split_node)

    def _best_cut(self, graph: SurfaceGraph) -> _Candidate:
        cut = SOLVERS[self._parameters.solver](graph, self._parameters, self._rng)
        cut = with_connected_sides(graph, cut)
        late = min(cut.inside, cut.outside) < _SMALLEST_SIDE * self._total
        value = cut.ncc if self._parameters.order == "ncc" else cut.ncut
        return _Candidate(cut, value * np.sqrt(self._total), late)


def _part(segment: _Segment, side: BoolArray) -> _Segment:
    local = np.flatnonzero(side).astype(np.int32)
    return _Segment(segment.nodes[local], segment.graph.subgraph(local))


def with_connected_sides(graph: SurfaceGraph, cut: Cut) -> Cut:
    """The best cut (by NCC) of a connected graph that parts off one of the connected pieces that a cut leaves.

    The complement of a piece can itself fall apart. Its pieces then all touch the one taken first, so that any of them
    has a connected complement, and the best of them is taken.
    """
    pieces = _pieces(graph, cut.side)
    if pieces.max() <= 1:
        return cut
    best = _best_piece(graph, pieces)
    pieces = _pieces(graph, best.side)
    if pieces.max() <= 1:
        return best
    inside = pieces[np.argmax(best.side)]
    return _best_piece(graph, pieces, excluded=int(inside))


def _pieces(graph: SurfaceGraph, side: BoolArray) -> IntArray:
    """(N,) the connected piece of every node when the edges across the cut are taken away."""
    kept = side[graph.edges[:, 0]] == side[graph.edges[:, 1]]
    return connected_components(SurfaceGraph(graph.edges[kept], graph.weight[kept], graph.volume))


def _best_piece(graph: SurfaceGraph, pieces: IntArray, excluded: int = -1) -> Cut:
    """The piece with the least NCC against everything else."""
    count = int(pieces.max()) + 1
    ends = pieces[graph.edges]
    crossing = ends[:, 0] != ends[:, 1]
    border = group_sums(ends[crossing].ravel(), np.repeat(graph.weight[crossing], 2), count)
    volume = group_sums(pieces, graph.volume, count)
    ncc = border / np.minimum(volume, graph.total_volume - volume)
    if excluded >= 0:
        ncc[excluded] = np.inf
    return cut_of(graph, pieces == int(np.argmin(ncc)))
