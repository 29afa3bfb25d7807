"""What the command line says about the number of segments and the end of the hierarchy."""

from dataclasses import replace

import pytest

from helpers.files.hierarchies import two_strips
from segcore.levels import Fineness
from service.commands.summary import level_summary


@pytest.mark.parametrize(
    ("limit_reached", "end"),
    [
        (True, "the hierarchy ends at the limit of 3: raise max_segments for more"),
        (False, "the hierarchy ends at 3: no sensible cut is left"),
        (None, "1 to 3 are possible"),
    ],
)
def test_the_summary_says_where_the_hierarchy_ends_and_why(limit_reached: bool | None, end: str) -> None:
    hierarchy = replace(two_strips()[1], limit_reached=limit_reached)
    assert level_summary(hierarchy, 2, Fineness()) == f"2 segments, chosen automatically; {end}"
    assert level_summary(hierarchy, 3, Fineness(segments=3)) == f"3 segments, as requested; {end}"


def test_one_segment_is_singular() -> None:
    assert level_summary(two_strips()[1], 1, Fineness(segments=1)).startswith("1 segment, as requested; ")
