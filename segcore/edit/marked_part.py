"""The part that a person means who marks some nodes, found mark by mark."""

from collections import OrderedDict

from segcore.arrays import BoolArray
from segcore.edit.corrections import Mark, corrected, first_part
from segcore.edit.tree_parts import TreeParts

_REMEMBERED = 32  # parts; a person adds marks one by one
_MOST_CORRECTIONS = 64  # marks of one part that may change more than their own node; set by hand


class MarkedParts:
    """Finds parts of one hierarchy; a part of the same marks and one more is found faster.

    The first mark selects a part of the hierarchy. Then the first mark that is on the wrong side corrects the part,
    until there is none. The result depends on the marks and their order alone.
    """

    def __init__(self, parts: TreeParts) -> None:
        self._parts = parts
        self._known: OrderedDict[tuple[Mark, ...], BoolArray] = OrderedDict()

    def of(self, marks: list[Mark]) -> BoolArray:
        """(N,) the part of a list of marks, the first of which is inside; all marks are obeyed."""
        used = [marks[0]]
        inside = self._part_of(used, None)
        while wrong := [mark for mark in marks if inside[mark.node] != mark.is_inside]:
            if len(used) == _MOST_CORRECTIONS:
                inside = inside.copy()
                for mark in wrong:
                    inside[mark.node] = mark.is_inside
                return inside
            used.append(wrong[0])
            inside = self._part_of(used, inside)
        return inside

    def _part_of(self, used: list[Mark], before: BoolArray | None) -> BoolArray:
        """(N,) the part of some marks, given that of all but the last."""
        key = tuple(used)
        if key not in self._known:
            if before is None:
                self._known[key] = first_part(self._parts, used[0].node)
            else:
                self._known[key] = corrected(self._parts, before, used)
            if len(self._known) > _REMEMBERED:
                self._known.popitem(last=False)
        self._known.move_to_end(key)
        return self._known[key]
