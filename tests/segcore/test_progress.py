from itertools import pairwise

import numpy as np
import pytest

from segcore import shapes
from segcore.method import segment
from segcore.progress import Progress

STAGES = ["clean", "affinity", "coarsen", "cut", "label"]


@pytest.mark.parametrize("face_count", [1, 20_000, 2_000_000, 10**9])
def test_fractions_run_from_0_to_1_whatever_the_size(face_count):
    told = []
    progress = Progress(lambda _, fraction: told.append(fraction), face_count)
    for stage in STAGES:
        progress(stage)
        progress(stage, 0.5)
    progress("label", 1.0)
    assert told[0] == 0
    assert told[-1] == pytest.approx(1)
    assert all(a < b for a, b in pairwise(told))


def test_the_cuts_are_most_of_the_work_on_a_small_mesh_and_next_to_none_on_a_huge_one():
    share = {}
    for size in (10_000, 2_000_000):
        told = {}
        progress = Progress(told.__setitem__, size)
        progress("cut")
        progress("label")
        share[size] = told["label"] - told["cut"]
    assert share[10_000] > 0.4
    assert share[2_000_000] < 0.1


def test_the_first_of_many_splits_take_longest():
    told = []
    progress = Progress(lambda _, fraction: told.append(fraction), 10_000)
    progress("cut")
    for segments in (2, 4, 8, 16, 32, 64):
        progress.after_splits(64, segments / 64)
    progress("label")
    assert told[-2] == pytest.approx(told[-1])
    np.testing.assert_allclose(np.diff(told[:-1]), (told[-1] - told[0]) / 6)


@pytest.mark.parametrize("stage", STAGES)
def test_a_callback_that_raises_ends_the_work_and_leaves_nothing_behind(stage):
    class EnoughError(Exception):
        pass

    def end(told, _):
        if told == stage:
            raise EnoughError

    mesh = shapes.burr(3).mesh
    before = mesh.vertices.tobytes(), mesh.faces.tobytes()
    whole = segment(mesh)
    with pytest.raises(EnoughError):
        segment(mesh, on_progress=end)
    assert (mesh.vertices.tobytes(), mesh.faces.tobytes()) == before
    assert segment(mesh).face_leaf.tobytes() == whole.face_leaf.tobytes()
