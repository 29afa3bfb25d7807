"""Best-first bisection of a graph into a tree of segments."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from heapq import heappop, heappush

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.coarsen.authored import group_by_part
from segcore.cut.bodies import cuts_between_pieces, pieces_of
from segcore.cut.fields import Segment
from segcore.cut.rules import Split, SplitRule
from segcore.cut.symmetric_cuts import symmetric_cuts
from segcore.graphs.surface_graph import SurfaceGraph, connected_components
from segcore.graphs.tree import Tree
from segcore.symmetry.clusters import local_image

_LAST = 1e6  # priority beyond that of every split


def bisect(
    graph: SurfaceGraph,
    points: FloatArray,
    rule: SplitRule,
    max_segments: int,
    on_split: Callable[[float], None] = lambda _: None,
    authored: IntArray | None = None,
    image: IntArray | None = None,
    body: IntArray | None = None,
    most_bodies: int = 0,
    only_sensible: bool = False,
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
    image : (N,) the mirror image of every node, an automorphism of the graph without a fixed point; None if there is
        none. A cut and its image are one step.
    body : (N,) the body of every node; None if there is one body.
    most_bodies : if there are more bodies than ``max_segments``, they are parted until there are this many segments.
    only_sensible : True to end as well if the rule finds no sensible split left.

    Notes
    -----
    Nodes keep their volumes in every segment. A cut whose smaller side has less than 0.2 % of the total volume comes
    after all others. The last step may be incomplete if it has more splits than there may be.
    """
    component = connected_components(graph.edges, graph.node_count)
    tree = _GrowingTree(graph, rule, max_segments, image)
    for twins in tree.part_components(component, group_by_part(points, component, authored)):
        tree.add(twins)
    while tree.segments < max_segments and (tree.is_sensible_left or not only_sensible) and tree.split_next():
        on_split(tree.segments / max_segments)
    tree.limit_reached = tree.is_sensible_left
    if body is not None:
        tree.part_bodies(body, most_bodies)
    finished = tree.finished()
    return finished if authored is None else replace(finished, automatic_segments=int(authored.max()) + 1)


@dataclass(frozen=True, slots=True, eq=False)
class _Copy:
    """A segment as a node of the tree."""

    node: int
    nodes: IntArray  # (M,) of the graph; those of two copies at the same place are images of each other


@dataclass(frozen=True, slots=True, eq=False)
class _Twins:
    """A segment and its images, which are split alike in one step."""

    segment: Segment  # the first copy
    copies: list[_Copy]
    image: IntArray | None  # (M,) the place of the image of every node, if the segment is its own image

    def part(self, side: BoolArray, nodes: list[int], split: Split) -> "_Twins":
        """The twins of one side of a cut.

        Parameters
        ----------
        nodes : of the tree, one for every copy; two for every copy if the image of the side is a part as well.
        """
        local = np.flatnonzero(side).astype(np.int32)
        places = [local] if len(nodes) == len(self.copies) or self.image is None else [local, self.image[local]]
        members = [copy.nodes[place] for copy in self.copies for place in places]
        copies = [_Copy(node, part) for node, part in zip(nodes, members, strict=True)]
        segment = self.segment
        graph = segment.graph.subgraph(local)
        part = Segment(copies[0].nodes, graph, segment.depth + 1, split.cut.ncut)
        return _Twins(part, copies, None if self.image is None else local_image(local, self.image))


class _GrowingTree:
    """The state of a best-first bisection."""

    def __init__(self, graph: SurfaceGraph, rule: SplitRule, max_segments: int, image: IntArray | None) -> None:
        self._graph = graph
        self._rule = rule
        self._max_segments = max_segments
        self._image = image
        self.limit_reached = False
        self._volume = graph.volume
        self._split_node: list[int] = []
        self._splits: list[Split | None] = []
        self._step: list[int] = []
        self._queue: list[tuple[bool, float, int]] = []
        self._waiting: dict[int, _Twins] = {}
        self._best: dict[int, Split] = {}
        self._leaf = np.zeros(graph.node_count, dtype=np.int32)

    @property
    def segments(self) -> int:
        return len(self._split_node) + 1

    def part_components(self, component: IntArray, merges: IntArray) -> list[_Twins]:
        """Split groups of components in the reverse order of their merges; return the components.

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
            node_of_group[larger], node_of_group[smaller] = self._split(
                int(node_of_group[count + i]), None, self._next_step()
            )
        members = np.split(np.argsort(component, kind="stable"), np.cumsum(np.bincount(component))[:-1])
        copies = [_Copy(int(node_of_group[c]), members[c].astype(np.int32)) for c in range(count)]
        return self._twins(component, copies)

    def _twins(self, component: IntArray, copies: list[_Copy]) -> list[_Twins]:
        """The components, those that are images of each other together."""
        if self._image is None:
            return [_Twins(self._segment(copy), [copy], None) for copy in copies]
        twins = []
        for c, copy in enumerate(copies):
            images = self._image[copy.nodes]
            other = int(component[images[0]])
            if other == c:
                twins.append(_Twins(self._segment(copy), [copy], local_image(copy.nodes, self._image)))
            elif c < other:
                twins.append(_Twins(self._segment(copy), [copy, _Copy(copies[other].node, images)], None))
        return twins

    def _segment(self, copy: _Copy) -> Segment:
        return Segment(copy.nodes, self._graph.subgraph(copy.nodes), 0, 0.0)

    def add(self, twins: _Twins) -> None:
        """Add segments to the queue; find their best split now unless the split can only be a late one."""
        node, segment = twins.copies[0].node, twins.segment
        self._place(twins)
        volume = segment.graph.total_volume
        if len(segment.nodes) == 1:
            return
        if volume >= self._rule.smallest_segment:
            self._best[node] = self._rule.best_split(segment, twins.image)
            if not self._best[node].late:
                heappush(self._queue, (False, self._best[node].priority, node))
                return
        heappush(self._queue, (True, -volume, node))

    def _place(self, twins: _Twins) -> None:
        self._waiting[twins.copies[0].node] = twins
        for copy in twins.copies:
            self._leaf[copy.nodes] = copy.node

    def split_next(self) -> bool:
        """Make the next step; return False if every segment is a single node."""
        if not self._queue:
            return False
        _, _, node = heappop(self._queue)
        twins = self._waiting.pop(node)
        split = self._best.pop(node, None) or self._rule.best_split(twins.segment, twins.image)
        for part in self._parts(twins, split):
            self.add(part)
        return True

    @property
    def is_sensible_left(self) -> bool:
        """Whether a split is left that is worth making and not a late one."""
        return bool(self._queue) and self._rule.is_sensible(*self._queue[0][:2])

    def part_bodies(self, body: IntArray, most: int) -> None:
        """Make cuts between bodies alone, which need no eigenvectors, until there are ``most`` segments.

        Parameters
        ----------
        body : (N,) the body of every node.
        """
        self._max_segments = max(self._max_segments, most)
        left = [self._waiting[node] for _, _, node in sorted(self._queue, reverse=True)]
        while left and self.segments < most:
            twins = left.pop()
            graph = twins.segment.graph
            cuts = cuts_between_pieces(graph, pieces_of(graph, body[twins.segment.nodes]))
            if twins.image is not None:
                cuts = symmetric_cuts(graph, twins.image, [cut.side for cut in cuts])
            if cuts:
                split = self._rule.best_among(twins.segment, cuts)
                parts = self._parts(twins, split if twins.image is None else split.with_image(twins.image))
                for part in parts:
                    self._place(part)
                left += parts

    def _parts(self, twins: _Twins, split: Split) -> list[_Twins]:
        """Make the same split of all copies; return the parts, the larger first."""
        step = self._next_step()
        cut_off, left = [], []
        for copy in twins.copies:
            node, rest = self._cut_off(copy.node, split, step)
            cut_off.append(node)
            if split.image is not None:
                node, rest = self._cut_off(rest, split.second, step)
                cut_off.append(node)
            left.append(rest)
        side = split.cut.side
        if split.image is not None:
            return [twins.part(~(side | split.image), left, split), twins.part(side, cut_off, split)]
        if twins.image is not None and (side != side[twins.image]).all():
            nodes = [node for both in zip(cut_off, left, strict=True) for node in both]
            return [twins.part(side, nodes, split)]
        parts = [twins.part(side, cut_off, split), twins.part(~side, left, split)]
        return parts if split.cut.inside >= split.cut.outside else parts[::-1]

    def _cut_off(self, node: int, split: Split, step: int) -> tuple[int, int]:
        """Split a node unless the limit is reached; return the nodes of the side of the cut and of the rest."""
        if self.segments >= self._max_segments:
            self._postpone(step)
            return node, node
        larger, smaller = self._split(node, split, step)
        return (larger, smaller) if split.cut.inside >= split.cut.outside else (smaller, larger)

    def _postpone(self, step: int) -> None:
        """Let an incomplete step come after all others."""
        for i, split in enumerate(self._splits):
            if self._step[i] == step and split is not None:
                self._splits[i] = replace(split, priority=_LAST)

    def finished(self) -> Tree:
        """Return the tree in the order of the rule."""
        values = np.array([split.value if split else 0.0 for split in self._splits])
        step = np.array(self._step, dtype=np.int32)
        tree = Tree(np.array(self._split_node, dtype=np.int32), values, self._leaf, 1, step, self.limit_reached)
        return self._rule.finished(tree, self._splits)

    def _next_step(self) -> int:
        return self._step[-1] + 1 if self._step else 0

    def _split(self, node: int, split: Split | None, step: int) -> tuple[int, int]:
        """Append a split of a node; return its two children."""
        self._split_node.append(node)
        self._splits.append(split)
        self._step.append(step)
        return 2 * len(self._split_node) - 1, 2 * len(self._split_node)
