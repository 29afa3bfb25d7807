"""Components, cuts in flat faces and mirror images of shapes with known values."""

import math

import numpy as np
import pytest

from bench.assets.shape import component_labels, flat_share, mirror_disagreement
from helpers.bench.strips import strip
from segcore.arrays import FloatArray
from segcore.clean.surface import build_surface
from segcore.mesh import Mesh
from segcore.shapes import box, icosphere, joined


def test_components_are_those_of_the_welded_mesh() -> None:
    pair = joined(box(), box(centre=(5, 0, 0)))
    unwelded = Mesh(pair.mesh.corners.reshape(-1, 3), np.arange(72).reshape(24, 3))
    labels = component_labels(build_surface(unwelded))
    assert np.array_equal(labels, labels[[0, 12]].repeat(12))
    assert sorted(set(labels.tolist())) == [0, 1]


def test_the_share_of_a_cut_in_flat_faces_is_measured_by_length() -> None:
    surface = build_surface(box())
    corner = np.zeros(12, dtype=np.int32)
    corner[0] = 1  # one of two triangles of a side: two edges of length 1 and the diagonal
    assert flat_share(surface, corner) == pytest.approx(math.sqrt(2) / (2 + math.sqrt(2)))
    side = np.zeros(12, dtype=np.int32)
    side[:2] = 1
    assert flat_share(surface, side) == 0.0
    assert flat_share(surface, np.zeros(12, dtype=np.int32)) == 0.0


@pytest.mark.parametrize(("degrees", "share"), [(0.9, 1.0), (1.1, 0.0)])
def test_faces_are_coplanar_to_within_a_degree(degrees: float, share: float) -> None:
    vertices, faces = strip(2)
    bent = vertices + np.maximum(vertices[:, :1] - 1, 0) * [0, 0, math.tan(math.radians(degrees))]
    assert flat_share(build_surface(Mesh(bent, faces)), np.array([0, 0, 1, 1], dtype=np.int32)) == share


@pytest.fixture
def centres() -> FloatArray:
    """(1280, 3) points that are symmetric in x alone, about the plane x = 7."""
    points = icosphere(3).corners.mean(axis=1)
    return points + np.where(points[:, [2]] > 0, 0.5, 0) * [0, 1, 1] + [7, 0, 0]


def test_labels_agree_with_their_mirror_image_if_both_sides_are_cut_alike(centres: FloatArray) -> None:
    area = np.ones(len(centres))
    side = np.sign(centres[:, 0] - 7).astype(np.int32) + 1
    assert mirror_disagreement(centres, area, side) == 0.0
    assert mirror_disagreement(centres, area, (centres[:, 1] > 0.3).astype(np.int32)) == 0.0
    caps = np.where(np.abs(centres[:, 0] - 7) > 0.8, side, 1)
    assert len(set(caps.tolist())) == 3
    assert mirror_disagreement(centres, area, caps) == 0.0


def test_a_cut_on_one_side_disagrees_with_its_mirror_image(centres: FloatArray) -> None:
    cap = (centres[:, 0] > 7.8).astype(np.int32)
    share = cap.mean()
    # The cap is apart from the rest in one of the two, and its image in the other: pairs of either with the rest.
    expected = 2 * 2 * share * (1 - 2 * share)
    assert mirror_disagreement(centres, np.ones(len(centres)), cap) == pytest.approx(expected)
