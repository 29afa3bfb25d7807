"""Near points agree with those that numpy finds from all distances."""

import numpy as np
import pytest

from segcore.clean.near_segments import near_segments


def searched(points, segments, radius):
    """Search segments (S, 2, 3) whose ends are added after the points; return the pairs with the points."""
    ends = len(points) + np.arange(2 * len(segments), dtype=np.int32).reshape(-1, 2)
    found = near_segments(np.concatenate([points, segments.reshape(-1, 3)]), ends, radius)
    return found[found[:, 1] < len(points)]


@pytest.mark.parametrize("seed", range(3))
def test_near_points_are_those_of_all_distances(seed: int) -> None:
    """Segments of many lengths and radii; points beyond the ends, and the ends themselves, are not beside a segment."""
    rng = np.random.default_rng(seed)
    points = rng.random((400, 3)) * [1, 1, 0.05]
    begin = rng.random((60, 3)) * [1, 1, 0.05]
    step = rng.normal(size=(60, 3)) * 10 ** rng.uniform(-3, 0, (60, 1))
    radius = 10 ** rng.uniform(-3, -0.5, 60)
    points = np.concatenate([points, begin, begin + step])
    ends = np.stack([np.arange(400, 460), np.arange(460, 520)], axis=1).astype(np.int32)
    found = near_segments(points, ends, radius)
    offset = points[None] - begin[:, None]
    at = (offset * step[:, None]).sum(axis=2) / (step**2).sum(axis=1)[:, None]
    distance = np.linalg.norm(offset - at[:, :, None] * step[:, None], axis=2)
    is_end = (np.arange(520) == ends[:, :1]) | (np.arange(520) == ends[:, 1:])
    expected = np.argwhere((distance <= radius[:, None]) & (at >= -0.01) & (at <= 1.01) & ~is_end)
    assert len(expected) > 50
    assert sorted(map(tuple, found.tolist())) == sorted(map(tuple, expected.tolist()))


def test_a_segment_without_length_has_no_points_beside_it() -> None:
    points = np.zeros((3, 3))
    assert len(near_segments(points, np.array([[0, 1]], dtype=np.int32), np.array([0.1]))) == 0


def test_a_point_with_very_many_segments_is_in_a_thicket_and_left_out():
    turn = np.linspace(0, np.pi, 40, endpoint=False)
    ends = 0.1 * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    segments = np.stack([-ends, ends], axis=1)  # all through the origin
    points = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [1.0, 1.0, 1.0]])
    pairs = searched(points, segments, np.full(40, 1e-3))
    assert 0 not in pairs[:, 1]
    assert [0, 1] in pairs.tolist()
    few = searched(points, segments[::2], np.full(20, 1e-3))
    assert np.count_nonzero(few[:, 1] == 0) == 20


def test_the_search_along_segments_is_limited_and_begins_with_the_short_ones(monkeypatch):
    monkeypatch.setattr("segcore.clean.near_segments._MOST_SAMPLES", 1100)
    short = np.array([[[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]]])
    long = np.tile([[[0.0, 0.5, 0.0], [1.0, 0.5, 0.0]]], (3, 1, 1))
    points = np.array([[0.005, 0.0, 0.0], [0.5, 0.5, 0.0], [1.0, 1.0, 1.0]])
    pairs = searched(points, np.concatenate([long, short]), np.full(4, 1e-3))
    assert pairs.tolist() == [[0, 1], [1, 1], [3, 0]]
