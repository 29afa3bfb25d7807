"""How two readers of a file compare."""

from pathlib import Path

import numpy as np
import pytest

from bench.files.comparison import compare
from bench.files.three import compare_corners, farthest
from helpers.files.samples import OFF
from segcore.io import read_mesh

REFUSED = {"error": "InvalidMesh", "message": "it is cut short"}
FOUND = {"faces": 2, "area": 1.0, "notes": ["A note."]}


@pytest.mark.parametrize(
    ("ours", "theirs", "verdict", "reason"),
    [
        (FOUND, {"faces": 2, "area": 1 + 5e-7}, "equal", ""),
        (FOUND, {"faces": 2, "area": 1.1}, "other", "2 and 2 faces, area 1 and 1.1. A note."),
        (FOUND, {"faces": 3, "area": 1.0}, "other", "2 and 3 faces, area 1 and 1. A note."),
        (FOUND | {"area of fans": 1.1}, {"faces": 2, "area": 1.1}, "concave polygons", ""),
        (FOUND | {"area of fans": 1.2}, {"faces": 2, "area": 1.1}, "other", "2 and 2 faces, area 1 and 1.1. A note."),
        (FOUND, {"faces": 0, "area": 0.0}, "only Cleave", "no faces: "),
        (FOUND, {"error": "the program died"}, "only Cleave", "the program died: "),
        (REFUSED, {"faces": 2, "area": 1.0}, "only other", "it is cut short"),
        (REFUSED, {"error": "ValueError", "message": ""}, "both refuse", "it is cut short"),
        (REFUSED, {"faces": 0, "area": 0.0}, "both refuse", "it is cut short"),
    ],
)
def test_a_verdict_has_its_reason(ours: dict, theirs: dict, verdict: str, reason: str) -> None:
    found = compare(Path("a.off"), ours, theirs)
    assert (found.verdict, found.reason) == (verdict, reason)


def test_corners_may_begin_anywhere_in_any_direction_but_triangles_keep_their_order() -> None:
    corners = np.random.default_rng(1).normal(size=(4, 3, 3))
    turned = np.stack([corners[0], corners[1][[1, 2, 0]], corners[2][[2, 1, 0]], corners[3][[0, 2, 1]]])
    assert farthest(corners, turned) == 0
    moved = turned.copy()
    moved[3, 1, 2] += 0.25
    assert farthest(corners, moved) == pytest.approx(0.25)
    assert farthest(corners, turned[[1, 0, 2, 3]]) > 0.01


def test_corners_of_a_file_are_compared_with_those_of_another_reader(tmp_path: Path) -> None:
    path = tmp_path / "a.off"
    path.write_bytes(OFF)
    corners = read_mesh(path).corners
    assert compare_corners(path, corners, {}).verdict == "equal"
    assert compare_corners(path, corners * (1 + 1e-5), {}).verdict == "other"
    assert compare_corners(path, corners[:1], {}).reason == "2 and 1 faces"
    assert compare_corners(path, None, {"error": "no"}).verdict == "only Cleave"
    path.write_bytes(OFF[:-9])
    assert compare_corners(path, corners, {}).verdict == "only other"
    assert compare_corners(path, None, {"error": "no"}).verdict == "both refuse"
