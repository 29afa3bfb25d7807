"""Siblings: equal parts of one body, such as the legs of a table or the links of a chain, whose splits become one step.

The order of the splits stays what it is. Splits of equal parts become one step even if they are not consecutive in it:
then other parts of the mesh are split in between. A few other parts that are cut off the same body in between belong to
the step as well.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from math import inf, log
from typing import NamedTuple

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.cut.node_shapes import Shapes, cuts_of, shapes_of
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.graphs.tree import Tree
from segcore.nary import numbered_steps

# Set by hand. Parts are equal, and cuts similar, if the values of no two of them differ by more.
_AREA = log(1.3)  # of the logarithm of the area
_SPREAD = 0.15  # of the standard deviations along the principal axes, in the largest one
_LENGTH = log(1.5)  # of the logarithm of the length of a cut
_AFFINITY = 0.5  # largest mean affinity of a cut between them: the guard at which clusters end, coarsen/matching.py
_MOST = 6  # groups that are kept of the parts below a node


def sibling_steps(graph: SurfaceGraph, points: FloatArray, tree: Tree) -> IntArray:
    """(S,) the steps of a tree, those of the splits that separate equal parts merged.

    The nodes below a node of the tree are siblings if all but at most one, the body, have about the same area and the
    same spread along their principal axes, and if the cuts between them are clear and have about the same length. This
    holds for parts that are cut off a body one after the other, and for chains of equal parts that are halved
    recursively. If there are several such sets of nodes below a node, the one with most nodes is taken. Sets of
    siblings of one body are joined if they are alike and fewer other parts are cut off in between.

    Parameters
    ----------
    points : (N, 3) positions of the nodes of the graph.
    tree : over the nodes of the graph. Splits that have a step in common keep it.
    """
    if len(tree.split_node) < 2:
        return tree.step
    cuts = _cuts(graph, tree)
    groups = _groups(_values(shapes_of(graph, points, tree)), cuts, tree)
    step = tree.step.tolist()
    merged = list(range(max(step) + 1))
    for chain in _chains(groups, tree):
        for splits in _alike_in(chain):
            steps = {_first(merged, step[split]) for split in splits}
            for other in steps:
                merged[other] = min(steps)
    return numbered_steps(np.array([_first(merged, s) for s in step], dtype=np.int32))


class _Values(NamedTuple):
    """What is compared, as the least or as the largest value over some parts and the cuts between them."""

    area: float  # logarithm
    spread: tuple[float, float, float]  # standard deviations along the principal axes, ascending
    length: float  # logarithm of the length of a cut


_NONE_LOW = _Values(inf, (inf, inf, inf), inf)
_NONE_HIGH = _Values(-inf, (-inf, -inf, -inf), -inf)


@dataclass(frozen=True, slots=True)
class _Group:
    """Nodes that make up a node of the tree: equal ones, and at most one body."""

    equal: tuple[int, ...]
    body: tuple[int, ...]  # one node or none
    low: _Values = _NONE_LOW
    high: _Values = _NONE_HIGH

    @property
    def is_step(self) -> bool:
        """Whether several splits separate equal parts."""
        return len(self.equal) >= 2 and len(self.equal) + len(self.body) >= 3

    def joined(self, other: "_Group", length: float | None = None) -> "_Group | None":
        """The equal parts of both and the body of either; None if the parts are not equal, or both have a body.

        Parameters
        ----------
        length : of the cut that separates the groups, if one does.
        """
        if self.body and other.body:
            return None
        if max(self.high.area, other.high.area) - min(self.low.area, other.low.area) > _AREA:
            return None
        cut = (inf, -inf) if length is None else (length, length)
        low, high = _least(self.low, other.low, cut[0]), _largest(self.high, other.high, cut[1])
        if high.length - low.length > _LENGTH:
            return None
        if any(b - a > _SPREAD * high.spread[-1] for a, b in zip(low.spread, high.spread, strict=True)):
            return None
        return _Group(self.equal + other.equal, self.body + other.body, low, high)


def _least(a: _Values, b: _Values, length: float) -> _Values:
    (p, q, r), (s, t, u) = a.spread, b.spread
    return _Values(min(a.area, b.area), (min(p, s), min(q, t), min(r, u)), min(a.length, b.length, length))


def _largest(a: _Values, b: _Values, length: float) -> _Values:
    (p, q, r), (s, t, u) = a.spread, b.spread
    return _Values(max(a.area, b.area), (max(p, s), max(q, t), max(r, u)), max(a.length, b.length, length))


def _groups(shapes: list[_Values], cuts: list[float | None], tree: Tree) -> list[list[_Group]]:
    """The groups that make up every node: those with most equal parts first, and last the node itself."""
    groups = [
        [_Group((node,), (), low, low._replace(length=-inf)), _Group((), (node,))] for node, low in enumerate(shapes)
    ]
    for split, (node, length) in reversed(list(enumerate(zip(tree.split_node.tolist(), cuts, strict=True)))):
        if length is not None:
            pairs = product(groups[2 * split + 1], groups[2 * split + 2])
            found = [group for one, other in pairs if (group := one.joined(other, length)) is not None]
            groups[node] = sorted(found, key=lambda group: -len(group.equal))[:_MOST] + groups[node]
    return groups


class _Link(NamedTuple):
    """What is cut off a body at a place in the tree: equal parts, or a single one."""

    splits: list[int]
    parts: int
    group: _Group | None  # None if the cut is not clear


def _chains(groups: list[list[_Group]], tree: Tree) -> Iterator[list[_Link]]:
    """For every body, what is cut off it, from the first cut to the last. Every part is a body as well."""
    split_of = {node: split for split, node in enumerate(tree.split_node.tolist())}
    waiting = [0]
    while waiting:
        node, chain = waiting.pop(), []
        while node in split_of:
            larger, smaller = 2 * split_of[node] + 1, 2 * split_of[node] + 2
            group = next((group for group in groups[node] if group.is_step), None)
            if group is None:
                single = next((group for group in groups[node] if group.equal == (smaller,)), None)
                chain.append(_Link([split_of[node]], 1, single))
                group = _Group((smaller,), (larger,))
            else:
                splits = _splits_between(node, {*group.equal, *group.body}, split_of)
                chain.append(_Link(splits, len(group.equal), group))
            waiting += group.equal
            node = group.body[0] if group.body else -1
        yield chain


def _splits_between(node: int, parts: set[int], split_of: dict[int, int]) -> list[int]:
    """The splits of a node that separate its parts."""
    splits, inside = [], [node]
    while inside:
        if (at := inside.pop()) not in parts:
            splits.append(split_of[at])
            inside += [2 * split_of[at] + 1, 2 * split_of[at] + 2]
    return splits


def _alike_in(chain: list[_Link]) -> Iterator[list[int]]:
    """The splits of links whose parts are equal, with those of the links in between, if these have fewer parts."""
    first = 0
    while first < len(chain):
        last, others, between = first, 0, 0
        group = chain[first].group
        for i in range(first + 1, len(chain)):
            both = _equal_parts(group, chain[i].group)
            if both is not None and others + between < len(both.equal):
                last, group, others, between = i, both, others + between, 0
            elif group is None or others + (between := between + chain[i].parts) > len(group.equal):
                break
        yield [split for link in chain[first : last + 1] for split in link.splits]
        first = last + 1


def _equal_parts(one: _Group | None, other: _Group | None) -> _Group | None:
    """The parts of two groups of one body, if they are equal."""
    return None if one is None or other is None else one.joined(_Group(other.equal, (), other.low, other.high))


def _first(merged: list[int], step: int) -> int:
    """The first of the steps that a step has been merged with."""
    while merged[step] != step:
        step = merged[step]
    return step


def _values(shapes: Shapes) -> list[_Values]:
    """The values of every node, with the least length of no cuts."""
    return [
        _Values(area, (p, q, r), inf)
        for area, (p, q, r) in zip(shapes.log_area.tolist(), shapes.spread.tolist(), strict=True)
    ]


def _cuts(graph: SurfaceGraph, tree: Tree) -> list[float | None]:
    """The logarithm of the length of the cut of every split; None if the cut is not clear."""
    cuts = cuts_of(graph, tree)
    is_clear = cuts.weight <= _AFFINITY * cuts.length
    return [value if clear else None for value, clear in zip(cuts.log_length.tolist(), is_clear.tolist(), strict=True)]
