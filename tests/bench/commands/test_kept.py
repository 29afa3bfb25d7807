"""The table of files and their outputs that keep everything."""

import numpy as np
import pytest

from bench.commands.kept import render
from bench.kept.check import Comparison, bands, largest_move
from segcore import shapes

SAME = Comparison("a.glb", 320, 5, 1000, 1500, 2, 0, [], 0, 5000, 0.0, 0)
OTHER = Comparison("b.glb", 4, 4, 1000, 1000, 1, 1, ["IMAGE_BROKEN"], 7, 5000, 0.25, 1)


def test_the_summary_counts_what_differs() -> None:
    lines = render([SAME, OTHER], ["c.glb: damaged"]).splitlines()
    assert lines[2].split() == ["a.glb", "320", "1.50", "2/2", "0", "0", "0"]
    assert lines[3].split() == ["b.glb", "4", "1.00", "0/1", "IMAGE_BROKEN", "7", "0.2"]
    assert lines[5] == (
        "2 files: 1 look the same in every pixel, 1 move as before, 1 pictures lost, "
        "1 with new errors of the validator."
    )
    assert lines[6] == "c.glb: damaged"


@pytest.mark.parametrize("faces", [1, 3, 80])
def test_bands_have_equal_numbers_of_faces(faces: int) -> None:
    mesh = shapes.icosphere(1)
    mesh = type(mesh)(mesh.vertices, mesh.faces[:faces])
    counts = np.bincount(bands(mesh).labels())
    assert len(counts) == min(5, faces)
    assert np.ptp(counts) <= 1


def test_triangles_may_be_in_any_order_and_begin_with_any_corner() -> None:
    corners = shapes.icosphere(1).corners
    assert largest_move(corners, np.roll(corners[::-1], 1, axis=1)) == 0
    assert largest_move(corners, corners[:, ::-1]) > 0.1
    assert largest_move(corners, corners[1:]) == float("inf")
    moved = corners.copy()
    moved[3] += 0.02
    assert largest_move(corners, moved) == pytest.approx(0.06 / np.ptp(corners.reshape(-1, 3)), rel=1e-3)
