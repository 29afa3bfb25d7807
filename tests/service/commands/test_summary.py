"""What the command line says about the number of segments and the end of the hierarchy."""

import re
from dataclasses import replace

import pytest

from helpers.files.hierarchies import two_strips
from segcore.levels import Fineness
from service.commands.summary import level_summary, part_lines


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


def test_the_largest_segments_are_listed_with_their_sizes() -> None:
    hierarchy = two_strips()[1]
    lines = part_lines(hierarchy, 3)
    assert len(lines) == 3
    assert all(re.fullmatch(r"  segment \d: \d+\.\d % of the area, \d+ faces", line) for line in lines)
    shares = [float(line.split()[2]) for line in lines]
    assert shares == sorted(shares, reverse=True)
    assert sum(shares) == pytest.approx(100, abs=0.2)


def test_of_very_many_segments_the_smaller_ones_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.commands.summary._MOST_LINES", 1)
    assert part_lines(two_strips()[1], 3)[1:] == ["  and 2 smaller ones"]
