"""Levels of a hierarchy: a requested number of segments, and hierarchies whose first splits a user has selected."""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from segcore.arrays import IntArray
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy, renumbered_nodes
from segcore.nary import numbered_steps


@dataclass(frozen=True, slots=True)
class Fineness:
    """A requested number of segments: a number, a granularity, or neither for the automatic number.

    Raises
    ------
    InvalidParameters
        If both are given.
    """

    segments: int | None = None
    granularity: float | None = None  # 0 coarse, 0.5 automatic, 1 fine; see ``Hierarchy.segments_at``

    def __post_init__(self) -> None:
        if self.segments is not None and self.granularity is not None:
            raise InvalidParameters("Give either segments or granularity, not both.")

    @property
    def is_automatic(self) -> bool:
        """Whether neither a number nor a granularity is given."""
        return self.segments is None and self.granularity is None

    def segments_of(self, hierarchy: Hierarchy) -> int:
        """The requested number of segments of a hierarchy.

        Raises
        ------
        InvalidParameters
            If the granularity is not in 0..1 or ``segments`` is not in 1..max_segments.
        """
        if self.granularity is not None:
            return hierarchy.segments_at(self.granularity)
        return len(hierarchy.segment_nodes(self.segments))


def one_segment_note(automatic_segments: int | None, max_segments: int | None) -> str | None:
    """A sentence on a hierarchy whose automatic number of segments is 1 although it has cuts; None for any other."""
    if automatic_segments != 1 or max_segments is None or max_segments == 1:
        return None
    numbers = "2 segments" if max_segments == 2 else f"a number of segments from 2 to {max_segments}"
    return f"No cut is clear enough to be made automatically: ask for {numbers} to see the best ones."


@dataclass(frozen=True, slots=True)
class Level:
    """A requested level: a fineness, or the splits to be made.

    Raises
    ------
    InvalidParameters
        If both are given.
    """

    fineness: Fineness = Fineness()
    splits: tuple[int, ...] | None = None

    def __post_init__(self) -> None:
        if self.splits is not None and not self.fineness.is_automatic:
            raise InvalidParameters("Give one of segments, granularity and splits, not several.")

    @property
    def is_automatic(self) -> bool:
        """Whether nothing is requested."""
        return self.splits is None and self.fineness.is_automatic

    def of(self, hierarchy: Hierarchy) -> tuple[Hierarchy, int]:
        """Return the hierarchy that has the level, with the splits in front, and the number of segments.

        Raises
        ------
        InvalidParameters
            If there is no such level.
        """
        if self.splits is None:
            return hierarchy, self.fineness.segments_of(hierarchy)
        return keep_splits(hierarchy, self.splits), len(set(self.splits)) + 1

    def labels(self, hierarchy: Hierarchy) -> IntArray:
        """(F,) the labels of the input faces at the level; errors as of :meth:`of`."""
        kept, segments = self.of(hierarchy)
        return kept.labels(segments)


def keep_splits(hierarchy: Hierarchy, splits: Collection[int]) -> Hierarchy:
    """The hierarchy with some splits moved to the front; its automatic number of segments makes exactly these splits.

    Split s makes the nodes 2 s + 1 and 2 s + 2. The other splits follow in their old order, so that every level is
    still a cut through the same tree. Nodes and labels are renumbered. If only some splits of a step are moved, the
    others become a step of their own.

    Parameters
    ----------
    splits : any of 0..max_segments - 2, if each comes with the split that makes the node that it cuts.

    Raises
    ------
    InvalidParameters
        If a split does not exist, or cuts a part that is made by a split that is not given.
    """
    count = hierarchy.max_segments - 1
    chosen = sorted(set(splits))
    for split in chosen:
        if not 0 <= split < count:
            raise InvalidParameters(f"The splits of this mesh are 0 to {count - 1}: there is no split {split}.")
        if (made_by := (int(hierarchy.split_node[split]) - 1) // 2) >= 0 and made_by not in splits:
            raise InvalidParameters(f"Split {split} cuts a part that split {made_by} makes: give both or neither.")
    order = np.array([*chosen, *sorted(set(range(count)) - set(chosen))], dtype=np.int32)
    return _reordered(hierarchy, order, len(chosen))


def _reordered(hierarchy: Hierarchy, order: IntArray, moved: int) -> Hierarchy:
    """The hierarchy with its splits in another order, of which the first ``moved`` have been moved to the front."""
    new_node = renumbered_nodes(order)
    old_node = np.argsort(new_node)
    is_moved = np.arange(len(order)) < moved
    return replace(
        hierarchy,
        split_node=new_node[hierarchy.split_node[order]],
        cut_value=hierarchy.cut_value[order],
        area=hierarchy.area[old_node],
        face_count=hierarchy.face_count[old_node],
        face_leaf=new_node[hierarchy.face_leaf],
        automatic_segments=moved + 1,
        step=numbered_steps(2 * hierarchy.step[order] + is_moved),
    )
