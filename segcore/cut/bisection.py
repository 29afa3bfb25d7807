"""Best-first bisection of a graph into a tree of segments."""

from collections.abc import Callable
from dataclasses import replace
from heapq import heappop, heappush

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.coarsen.authored import group_by_part
from segcore.cut.fields import Segment
from segcore.cut.rules import Split, SplitRule
from segcore.graphs.surface_graph import SurfaceGraph, connected_components
from segcore.graphs.tree import Tree


def bisect(
    graph: SurfaceGraph,
    points: FloatArray,
    rule: SplitRule,
    max_segments: int,
    on_split: Callable[[float], None] = lambda _: None,
    authored: IntArray | None = None,
) -> Tree:
    """Separate the components of a graph, then repeatedly cut the segment of highest priority.

    Parameters
    ----------
    points : (N, 3) positions of the nodes, by which near components are grouped.
    rule : chooses the cut of a segment, its priority, and the automatic number of segments.
    max_segments : limit of the segments; components are separated in any case.
    on_split : called with the fraction of ``max_segments`` that is reached.
    authored : (N,) the authored part of every node, if the first splits separate these. Their number is then the
        automatic number of segments.

    Notes
    -----
    Nodes keep their volumes in every segment. A cut whose smaller side has less than 0.2 % of the total volume comes
    after all others.
    """
    component = connected_components(graph.edges, graph.node_count)
    tree = _GrowingTree(graph, rule)
    for node, members in tree.part_components(component, group_by_part(points, component, authored)):
        tree.add(node, Segment(members, graph.subgraph(members), 0, 0.0))
    while tree.segments < max_segments and tree.split_next():
        on_split(tree.segments / max_segments)
    finished = tree.finished()
    return finished if authored is None else replace(finished, automatic_segments=int(authored.max()) + 1)


class _GrowingTree:
    """The state of a best-first bisection."""

    def __init__(self, graph: SurfaceGraph, rule: SplitRule) -> None:
        self._rule = rule
        self._volume = graph.volume
        self._split_node: list[int] = []
        self._splits: list[Split | None] = []
        self._queue: list[tuple[bool, float, int]] = []
        self._segments: dict[int, Segment] = {}
        self._best: dict[int, Split] = {}
        self._leaf = np.zeros(graph.node_count, dtype=np.int32)

    @property
    def segments(self) -> int:
        return len(self._split_node) + 1

    def part_components(self, component: IntArray, merges: IntArray) -> list[tuple[int, IntArray]]:
        """Split groups of components in the reverse order of their merges; return every component's node and members.

        Parameters
        ----------
        component : (N,) 0..C - 1.
        merges : (C - 1, 2) groups that are merged into group C, C + 1, ...; group i < C is component i.
        """
        count = len(merges) + 1
        volume = np.zeros(2 * count - 1)
        volume[:count] = group_sums(component, self._volume, count)
        for i, (a, b) in enumerate(merges.tolist()):
            volume[count + i] = volume[a] + volume[b]
        node_of_group = np.zeros(2 * count - 1, dtype=np.int32)
        for i, (a, b) in reversed(list(enumerate(merges.tolist()))):
            larger, smaller = (a, b) if volume[a] >= volume[b] else (b, a)
            node_of_group[larger], node_of_group[smaller] = self._split(int(node_of_group[count + i]), None)
        members = np.split(np.argsort(component, kind="stable"), np.cumsum(np.bincount(component))[:-1])
        return [(int(node_of_group[c]), members[c].astype(np.int32)) for c in range(count)]

    def add(self, node: int, segment: Segment) -> None:
        """Add a segment to the queue; find its best split now unless the split can only be a late one."""
        self._segments[node] = segment
        self._leaf[segment.nodes] = node
        volume = segment.graph.total_volume
        if len(segment.nodes) == 1:
            return
        if volume >= self._rule.smallest_segment:
            self._best[node] = self._rule.best_split(segment)
            if not self._best[node].late:
                heappush(self._queue, (False, self._best[node].priority, node))
                return
        heappush(self._queue, (True, -volume, node))

    def split_next(self) -> bool:
        """Make the next split; return False if every segment is a single node."""
        if not self._queue:
            return False
        _, _, node = heappop(self._queue)
        segment = self._segments.pop(node)
        split = self._best.pop(node, None) or self._rule.best_split(segment)
        larger, smaller = self._split(node, split)
        inside_larger = split.cut.side == (split.cut.inside >= split.cut.outside)
        self.add(larger, _part(segment, inside_larger, split))
        self.add(smaller, _part(segment, ~inside_larger, split))
        return True

    def finished(self) -> Tree:
        """Return the tree in the order of the rule."""
        values = np.array([split.value if split else 0.0 for split in self._splits])
        limited = any(not late for late, _, _ in self._queue)
        tree = Tree(np.array(self._split_node, dtype=np.int32), values, self._leaf, 1, limit_reached=limited)
        return self._rule.finished(tree, self._splits)

    def _split(self, node: int, split: Split | None) -> tuple[int, int]:
        """Append a split of a node; return its two children."""
        self._split_node.append(node)
        self._splits.append(split)
        return 2 * len(self._split_node) - 1, 2 * len(self._split_node)


def _part(segment: Segment, side: BoolArray, split: Split) -> Segment:
    local = np.flatnonzero(side).astype(np.int32)
    return Segment(segment.nodes[local], segment.graph.subgraph(local), segment.depth + 1, split.cut.ncut)
