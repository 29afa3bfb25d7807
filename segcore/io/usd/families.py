"""The levels of a hierarchy as families of subsets of faces."""

from collections.abc import Iterator

from segcore.hierarchy import Hierarchy

RECOMMENDED = "parts"  # the family of the automatic level
_MOST_SUBSETS = 4096  # of the levels beside the automatic one, set by hand: each is a prim of the file


def level_families(hierarchy: Hierarchy) -> Iterator[tuple[str, int]]:
    """Yield the name of the family and the number of segments of each level that is offered, the automatic one first.

    These are the levels after a step, from two segments on. Finer ones are left out if there would be more than 4,096
    subsets.
    """
    yield RECOMMENDED, hierarchy.automatic_segments
    left = _MOST_SUBSETS
    for count in hierarchy.step_ends[1:].tolist():
        left -= count
        if left < 0:
            return
        if count != hierarchy.automatic_segments:
            yield f"level_{count}", count
