"""Other cuts through the same tree: any splits first, for people who cut one part further than the others."""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from segcore.arrays import IntArray
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy, renumbered_nodes


@dataclass(frozen=True, slots=True)
class Fineness:
    """At most one of the two; with neither it is what the mesh itself suggests.

    Raises
    ------
    InvalidParameters
        Where both are given.
    """

    segments: int | None = None
    granularity: float | None = None  # 0 coarse, 0.5 automatic, 1 fine

    def __post_init__(self) -> None:
        if self.segments is not None and self.granularity is not None:
            raise InvalidParameters("Give either segments or granularity, not both.")

    @property
    def is_automatic(self) -> bool:
        return self.segments is None and self.granularity is None

    def segments_of(self, hierarchy: Hierarchy) -> int:
        """The number of segments that is meant, in this hierarchy.

        Raises
        ------
        InvalidParameters
            Where the granularity is not in 0..1, or the hierarchy has not as many segments.
        """
        if self.granularity is not None:
            return hierarchy.segments_at(self.granularity)
        return len(hierarchy.segment_nodes(self.segments))


def keep_splits(hierarchy: Hierarchy, splits: Collection[int]) -> Hierarchy:
    """The hierarchy with some splits moved to the front: they alone are made at its automatic number of segments.

    Split s is the one that makes the nodes 2 s + 1 and 2 s + 2. The other splits follow in their order, so that every
    level is still a cut through the same tree; nodes and labels are numbered anew.

    Parameters
    ----------
    splits : some of 0..max_segments - 2, and with each the split that makes the node that it cuts.

    Raises
    ------
    InvalidParameters
        Where a split does not exist or its part is not there without another split.
    """
    count = hierarchy.max_segments - 1
    chosen = sorted(set(splits))
    for split in chosen:
        if not 0 <= split < count:
            raise InvalidParameters(f"The splits of this mesh are 0 to {count - 1}: there is no split {split}.")
        if (made_by := (int(hierarchy.split_node[split]) - 1) // 2) >= 0 and made_by not in splits:
            raise InvalidParameters(f"Split {split} cuts a part that split {made_by} makes: give both or neither.")
    order = np.array([*chosen, *sorted(set(range(count)) - set(chosen))], dtype=np.int32)
    return _reordered(hierarchy, order, len(chosen) + 1)


def _reordered(hierarchy: Hierarchy, order: IntArray, segments: int) -> Hierarchy:
    new_node = renumbered_nodes(order)
    old_node = np.argsort(new_node)
    return Hierarchy(
        split_node=new_node[hierarchy.split_node[order]],
        cut_value=hierarchy.cut_value[order],
        area=hierarchy.area[old_node],
        face_count=hierarchy.face_count[old_node],
        face_leaf=new_node[hierarchy.face_leaf],
        automatic_segments=segments,
    )
