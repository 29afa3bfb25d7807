"""Open edges and near points agree with those that plain Python finds."""

from collections import Counter

import numpy as np
import pytest

from segcore import shapes
from segcore.clean.borders import ends_of, near_segments, open_edges
from segcore.clean.topology import dual_edges


@pytest.mark.parametrize("kept", [320, 300, 200])
def test_open_edges_have_one_face(kept: int) -> None:
    faces = np.concatenate([shapes.icosphere(2).faces[:kept], [[0, 50, 100]]]).astype(np.int32)
    uses = Counter(frozenset((int(f[k]), int(f[k - 1]))) for f in faces for k in range(3))
    borders = open_edges(faces, dual_edges(faces, 162))
    found = [frozenset(ends) for ends in ends_of(borders, faces).tolist()]
    assert sorted(map(sorted, found)) == sorted(sorted(edge) for edge, count in uses.items() if count == 1)


def test_a_closed_surface_has_no_open_edges() -> None:
    faces = shapes.icosphere(2).faces
    assert len(open_edges(faces, dual_edges(faces, 162))) == 0


@pytest.mark.parametrize("seed", range(3))
def test_near_points_are_those_of_all_distances(seed: int) -> None:
    """Segments of many lengths with radii of many sizes; points beyond the ends are not beside a segment."""
    rng = np.random.default_rng(seed)
    points = rng.random((400, 3)) * [1, 1, 0.05]
    begin = rng.random((60, 3)) * [1, 1, 0.05]
    step = rng.normal(size=(60, 3)) * 10 ** rng.uniform(-3, 0, (60, 1))
    radius = 10 ** rng.uniform(-3, -0.5, 60)
    found = near_segments(points, np.stack([begin, begin + step], axis=1), radius)
    offset = points[None] - begin[:, None]
    at = (offset * step[:, None]).sum(axis=2) / (step**2).sum(axis=1)[:, None]
    distance = np.linalg.norm(offset - at[:, :, None] * step[:, None], axis=2)
    expected = np.argwhere((distance <= radius[:, None]) & (at >= -0.01) & (at <= 1.01))
    assert len(expected) > 50
    assert sorted(map(tuple, found.tolist())) == sorted(map(tuple, expected.tolist()))


def test_a_segment_without_length_has_no_points_beside_it() -> None:
    points = np.zeros((3, 3))
    assert len(near_segments(points, np.zeros((1, 2, 3)), np.array([0.1]))) == 0


def test_a_point_with_very_many_segments_is_in_a_thicket_and_left_out():
    turn = np.linspace(0, np.pi, 40, endpoint=False)
    ends = 0.1 * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    segments = np.stack([-ends, ends], axis=1)  # all through the origin
    points = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [1.0, 1.0, 1.0]])
    pairs = near_segments(points, segments, np.full(40, 1e-3))
    assert 0 not in pairs[:, 1]
    assert [0, 1] in pairs.tolist()
    few = near_segments(points, segments[::2], np.full(20, 1e-3))
    assert np.count_nonzero(few[:, 1] == 0) == 20


def test_the_search_along_segments_is_limited_and_begins_with_the_short_ones(monkeypatch):
    monkeypatch.setattr("segcore.clean.borders._MOST_SAMPLES", 1100)
    short = np.array([[[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]]])
    long = np.tile([[[0.0, 0.5, 0.0], [1.0, 0.5, 0.0]]], (3, 1, 1))
    points = np.array([[0.005, 0.0, 0.0], [0.5, 0.5, 0.0], [1.0, 1.0, 1.0]])
    pairs = near_segments(points, np.concatenate([long, short]), np.full(4, 1e-3))
    assert pairs.tolist() == [[0, 1], [1, 1], [3, 0]]
