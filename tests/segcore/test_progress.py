from itertools import pairwise

import numpy as np
import pytest

from segcore import shapes
from segcore.method import segment
from segcore.progress import STAGES, Progress, seconds_left


def test_the_stages_are_those_of_the_documentation_in_order():
    assert STAGES == ("clean", "affinity", "coarsen", "cut", "label")


@pytest.mark.parametrize("face_count", [1, 20_000, 2_000_000, 10**9])
def test_fractions_run_from_0_to_1_for_any_size(face_count):
    reported = []
    progress = Progress(lambda _, fraction: reported.append(fraction), face_count)
    for stage in STAGES:
        progress(stage)
        progress(stage, 0.5)
    progress("label", 1.0)
    assert reported[0] == 0
    assert reported[-1] == pytest.approx(1)
    assert all(a < b for a, b in pairwise(reported))


def test_the_cuts_are_a_large_share_of_a_small_mesh_and_a_small_one_of_a_huge_mesh():
    share = {}
    for size in (10_000, 2_000_000):
        reported = {}
        progress = Progress(reported.__setitem__, size)
        progress("cut")
        progress("label")
        share[size] = reported["label"] - reported["cut"]
    assert share[10_000] > 0.3
    assert share[2_000_000] < 0.1


def test_the_first_splits_take_longest():
    reported = []
    progress = Progress(lambda _, fraction: reported.append(fraction), 10_000)
    progress("cut")
    for segments in (2, 4, 8, 16, 32, 64):
        progress.after_splits(64, segments / 64)
    progress("label")
    assert reported[-2] == pytest.approx(reported[-1])
    np.testing.assert_allclose(np.diff(reported[:-1]), (reported[-1] - reported[0]) / 6)


@pytest.mark.parametrize("stage", STAGES)
def test_a_callback_that_raises_ends_the_work_and_changes_nothing(stage):
    class EnoughError(Exception):
        pass

    def end(reported, _):
        if reported == stage:
            raise EnoughError

    mesh = shapes.burr(3).mesh
    before = mesh.vertices.tobytes(), mesh.faces.tobytes()
    whole = segment(mesh)
    with pytest.raises(EnoughError):
        segment(mesh, on_progress=end)
    assert (mesh.vertices.tobytes(), mesh.faces.tobytes()) == before
    assert segment(mesh).face_leaf.tobytes() == whole.face_leaf.tobytes()


def test_progress_moves_within_the_long_stages():
    reported = []
    segment(shapes.dumbbell().mesh, on_progress=lambda stage, fraction: reported.append((fraction, stage)))
    assert reported == sorted(reported, key=lambda report: report[0])
    stages = [stage for _, stage in set(reported)]
    assert stages.count("affinity") >= 5
    assert stages.count("coarsen") >= 4


@pytest.mark.parametrize("fraction", [0.01, 0.3, 0.5, 0.99, 1.0])
def test_work_at_an_even_speed_ends_within_a_second_of_the_estimate(fraction):
    whole_s = 200.0
    estimate = seconds_left(fraction * whole_s, fraction)
    assert 0 <= estimate - (1 - fraction) * whole_s <= 1


@pytest.mark.parametrize(("elapsed_s", "fraction"), [(0.9, 0.5), (100.0, 0.0)])
def test_there_is_no_estimate_in_the_first_second_and_before_anything_is_done(elapsed_s, fraction):
    assert seconds_left(elapsed_s, fraction) is None
