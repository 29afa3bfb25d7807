"""Changes of a part that put a marked node on its right side, and what speaks for each of them.

A person who marks a wrong face marks the middle of what is wrong. What is wrong is a part of the hierarchy that is
missing or too much; another part of the hierarchy altogether; or a piece between the border of the part and a better
border farther on, which is a minimum cut around the marked node.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.edit.distances import distances_from, distances_from_border, marked_components, nearest_seed
from segcore.edit.local_cut import minimum_cut
from segcore.edit.tree_parts import FEATURES as PART_FEATURES
from segcore.edit.tree_parts import TreeParts
from segcore.learned.choices import choice_models

KINDS = (
    "other_part",  # another part of the hierarchy
    "part",  # a part of the hierarchy is added or taken away
    "near_strip",  # the minimum cut within twice the depth of the mark behind the border
    "strip",  # the minimum cut within four times the depth
    "ball",  # the minimum cut within two and a half times the depth around the mark
    "region",  # the minimum cut of the whole part, or of all that is not in it
    "nearest",  # the nodes that are nearer to the mark than to the marks of the other side
)
FEATURES = (
    *KINDS,
    "log_probability_other_part",  # that a person who marks the first node means this part, for other_part
    "log_probability_part",  # that a person who marks this node means this part, for part
    "offset_other_part",  # distance of the mark from the centre of the change over its size, for other_part
    "offset",  # the same for the other kinds
    "log_offset",
    "log_depth",  # of the mark behind the border, over the size of the change
    "log_depth_squared",
    "log_change",  # area of the change over the total area
    "log_area",  # of the part after the change over the total area
    "log_area_squared",
    "affinity",  # mean along the new border
    "log_border",  # weight of the new border over the square root of the smaller area
    "border_change",  # difference of the weights of the borders over the size of the change
)
_SEED = 0.7  # of the depth of a mark: the nodes within change with it
_NEAR, _FAR, _BALL = 2.0, 4.0, 2.5  # depths, see KINDS
_WITHOUT_BORDER = 0.3  # of the square root of the area: the depth of a mark behind no border
_SMALL_AREA = 0.01  # of the total area


@dataclass(frozen=True, slots=True)
class Mark:
    """A node that a person put inside the part or outside it."""

    node: int
    is_inside: bool


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """The changes of one choice."""

    sets: list[BoolArray]  # (N,) each, the part after the change
    features: FloatArray  # (C, M)


def first_part(parts: TreeParts, node: int) -> BoolArray:
    """(N,) the part of the hierarchy that a person means who marks one node."""
    around = parts.around(node)
    return parts.mask(around[int(np.argmax(_log_probabilities(parts, around, node)))])


def corrected(parts: TreeParts, inside: BoolArray, marks: list[Mark]) -> BoolArray:
    """(N,) the part that a person means who marks one more node that is on the wrong side of a part.

    Parameters
    ----------
    inside : (N,) the part before.
    marks : all marks so far; the last one is new.
    """
    candidates = corrections(parts, inside, marks)
    return candidates.sets[int(np.argmax(choice_models().correction.log_probability(candidates.features)))]


def corrections(parts: TreeParts, inside: BoolArray, marks: list[Mark]) -> Candidates:
    """The different changes of a part that agree with all marks, the last of which is on the wrong side."""
    change = _Change(parts, inside, marks)
    sets: list[BoolArray] = []
    rows: list[FloatArray] = []
    seen: set[bytes] = set()
    for kind, after, log_probability in change.proposals():
        after = change.obeying(after)
        key = np.packbits(after).tobytes()
        if key not in seen:
            seen.add(key)
            sets.append(after)
            rows.append(change.features(kind, after, log_probability))
    return Candidates(sets, np.stack(rows))


def _log_probabilities(parts: TreeParts, around: list[int], node: int) -> FloatArray:
    assert choice_models().part.names == PART_FEATURES
    return choice_models().part.log_probability(parts.features(around, node))


class _Change:
    """The last mark of a list, and the part that it corrects."""

    def __init__(self, parts: TreeParts, inside: BoolArray, marks: list[Mark]) -> None:
        graph = parts.graph
        self._parts, self._graph, self._inside = parts, graph, inside
        self._mark = marks[-1]
        self._first = marks[0].node
        self._wanted = _nodes(mark for mark in marks if mark.is_inside)
        self._unwanted = _nodes(mark for mark in marks if not mark.is_inside)
        own, other = (self._wanted, self._unwanted) if self._mark.is_inside else (self._unwanted, self._wanted)
        self._own = own
        self._region = ~inside if self._mark.is_inside else inside  # contains the mark, and is too large
        self._opposite = other[self._region[other]]
        self._others = other
        self._total = float(graph.area.sum())
        away = distances_from_border(graph.rows, graph.step, self._region, np.inf)
        depth = float(away[self._mark.node])
        self._away = away
        self._depth = depth if np.isfinite(depth) else _WITHOUT_BORDER * float(np.sqrt(self._total))
        self._border = self._border_of(inside)

    def proposals(self) -> Iterator[tuple[str, BoolArray, float]]:
        """The kind, the part after the change, and the logarithm of a probability, 0 if there is none."""
        yield from self._other_parts()
        yield from self._parts_of_tree()
        near = self._near_mark(_BALL * self._depth)
        start = self._inside.copy()
        seed = near <= _SEED * self._depth
        seed[self._mark.node] = True
        start[seed] = self._mark.is_inside
        start = self._with_marks(start)
        movable = ~seed
        movable[self._wanted] = movable[self._unwanted] = False
        region = self._region & ~self._kept()
        for kind, where in (
            ("near_strip", self._away <= _NEAR * self._depth),
            ("strip", self._away <= _FAR * self._depth),
            ("ball", self._region & (near <= _BALL * self._depth)),
            ("region", region),
        ):
            yield kind, minimum_cut(self._graph.rows, self._graph.cost, start, where & movable), 0.0
        if len(self._opposite):
            seeds = np.concatenate([[self._mark.node], self._opposite]).astype(np.int32)
            nearest = nearest_seed(self._graph.rows, self._graph.resistance, self._region, seeds)
            after = self._inside.copy()
            after[nearest == 0] = self._mark.is_inside
            yield "nearest", after, 0.0

    def _other_parts(self) -> Iterator[tuple[str, BoolArray, float]]:
        around = self._parts.around(self._first)
        logs = _log_probabilities(self._parts, around, self._first)
        for part, log_probability in zip(around, logs.tolist(), strict=True):
            if self._parts.contains_all(part, self._wanted) and not self._parts.contains_any(part, self._unwanted):
                yield "other_part", self._parts.mask(part), log_probability

    def _parts_of_tree(self) -> Iterator[tuple[str, BoolArray, float]]:
        around = self._parts.around(self._mark.node)
        logs = _log_probabilities(self._parts, around, self._mark.node)
        for part, log_probability in zip(around, logs.tolist(), strict=True):
            if not self._parts.contains_any(part, self._others):
                mask = self._parts.mask(part)
                yield "part", self._inside | mask if self._mark.is_inside else self._inside & ~mask, log_probability

    def _near_mark(self, limit: float) -> FloatArray:
        return distances_from(self._graph.rows, self._graph.step, np.array([self._mark.node]), limit)

    def _kept(self) -> BoolArray:
        """(N,) the surroundings of the marks on the other side in the region, which keep their side."""
        kept = np.zeros(self._graph.count, dtype=bool)
        for node in self._opposite.tolist():
            depth = self._away[node]
            if np.isfinite(depth):
                kept |= np.isfinite(distances_from(self._graph.rows, self._graph.step, np.array([node]), _SEED * depth))
        return kept

    def _with_marks(self, inside: BoolArray) -> BoolArray:
        inside[self._wanted] = True
        inside[self._unwanted] = False
        return inside

    def obeying(self, inside: BoolArray) -> BoolArray:
        """The components of a set that contain marks, with all marks on their sides."""
        return marked_components(self._graph.rows, self._with_marks(inside.copy()), self._wanted)

    def features(self, kind: str, after: BoolArray, log_probability: float) -> FloatArray:
        """(M,) the features of a change."""
        graph, total = self._graph, self._total
        change = after != self._inside
        changed = float(graph.area[change].sum()) + 1e-12
        size = float(np.sqrt(changed))
        centre = (graph.points[change] * graph.area[change, None]).sum(axis=0) / changed
        offset = float(np.linalg.norm(centre - graph.points[self._mark.node])) / size if change.any() else 0.0
        area = float(graph.area[after].sum()) + 1e-12
        weight, length = self._border_of(after)
        smaller = max(min(area, total - area), 1e-12)
        is_other = kind == "other_part"
        log_depth, log_area = float(np.log(self._depth / size)), float(np.log(area / total))
        values = {
            kind: 1.0,
            "log_probability_other_part": log_probability if is_other else 0.0,
            "log_probability_part": log_probability if kind == "part" else 0.0,
            "offset_other_part": offset if is_other else 0.0,
            "offset": 0.0 if is_other else offset,
            "log_offset": 0.0 if is_other else float(np.log(0.1 + offset)),
            "log_depth": log_depth,
            "log_depth_squared": log_depth**2,
            "log_change": float(np.log(changed / total)),
            "log_area": log_area,
            "log_area_squared": log_area**2,
            "affinity": weight / max(length, 1e-12),
            "log_border": float(np.log(1e-3 + weight / np.sqrt(smaller))),
            "border_change": (weight - self._border[0]) / float(np.sqrt(changed + _SMALL_AREA * total)),
        }
        return np.array([values.get(name, 0.0) for name in FEATURES])

    def _border_of(self, inside: BoolArray) -> tuple[float, float]:
        """The weight and the length of the border of a set."""
        across = inside[self._graph.edges[:, 0]] != inside[self._graph.edges[:, 1]]
        return float(self._graph.weight[across].sum()), float(self._graph.length[across].sum())


def _nodes(marks: Iterator[Mark]) -> IntArray:
    return np.array([mark.node for mark in marks], dtype=np.int32)
