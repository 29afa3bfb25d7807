"""Runs of matches: their tolerance, and the orientations that they imply."""

import numpy as np
import pytest

from segcore.clean.runs import _orientable, _within_tolerance


@pytest.mark.parametrize(
    ("gaps", "within"),
    [
        ([1e-4, 2e-4, 3e-4], 3),  # nothing is farther
        ([1e-4] * 20 + [1.5e-4], 21),
        ([1e-4] * 20 + [5e-3] * 9, 20),  # the borders part abruptly
        ([1e-4 * 1.15**i for i in range(30)], 0),  # they diverge steadily
        ([1e-9, 1e-8, 1e-3], 3),  # up to the largest tolerance
        ([4e-3, 5e-3], 0),  # all beyond it
    ],
)
def test_the_tolerance_of_a_run_is_that_at_which_it_stops_growing(gaps: list[float], within: int) -> None:
    count = len(gaps)
    found = _within_tolerance(np.zeros(count, dtype=np.int32), np.array(gaps), np.ones(count))
    assert found.tolist() == [True] * within + [False] * (count - within)


def test_runs_have_tolerances_of_their_own() -> None:
    run = np.array([0, 0, 1, 1], dtype=np.int32)
    assert _within_tolerance(run, np.array([1e-6, 1e-6, 2e-3, 5e-3]), np.array([1, 1, 1, 0.05])).tolist() == [
        True,
        True,
        True,
        False,
    ]


def test_the_longest_runs_decide_the_orientations() -> None:
    """Three patches around a triangle of borders of which one is turned: the shortest contradicts the others."""
    between = np.array([[0, 1], [1, 2], [0, 2]], dtype=np.int32)
    turned = np.array([True, False, False])
    assert _orientable(between, turned, np.array([3.0, 2.0, 1.0])).tolist() == [True, True, False]
    assert _orientable(between, turned, np.array([1.0, 2.0, 3.0])).tolist() == [False, True, True]
    assert _orientable(between, np.array([True, True, False]), np.array([1.0, 1.0, 1.0])).all()


def test_a_patch_is_not_turned_against_itself() -> None:
    between = np.array([[4, 4], [4, 4]], dtype=np.int32)
    assert _orientable(between, np.array([True, False]), np.array([2.0, 1.0])).tolist() == [False, True]


@pytest.mark.parametrize("seed", range(3))
def test_orientations_that_a_two_colouring_gives_are_all_kept(seed: int) -> None:
    rng = np.random.default_rng(seed)
    side = rng.random(30) < 0.5
    between = np.sort(rng.integers(0, 30, (200, 2)), axis=1).astype(np.int32)
    turned = side[between[:, 0]] != side[between[:, 1]]
    assert _orientable(between, turned, rng.random(200)).all()
