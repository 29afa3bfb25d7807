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
