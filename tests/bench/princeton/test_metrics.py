"""The metrics of the Princeton benchmark against their definitions, on small surfaces."""

import math
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bench.princeton.metrics import METRICS, Scores, evaluate, mean_scores
from bench.princeton.surface import Segmentation, Surface
from helpers.bench.strips import cut_at, strip, strip_surface

COLUMNS, ROWS = 4, 2
FACES = 2 * COLUMNS * ROWS
SURFACE = strip_surface(COLUMNS, ROWS)
SYMMETRIC = tuple(set(METRICS) - {"missing_rate", "false_alarm_rate"})

labels_of_faces = st.lists(st.integers(-2, 4), min_size=FACES, max_size=FACES).map(np.array)
repeatable = settings(derandomize=True, database=None, deadline=None, max_examples=60)


def uneven_surface() -> Surface:
    """Return a strip with columns of different width, so that areas differ from numbers of faces."""
    vertices, faces = strip(COLUMNS, ROWS)
    return Surface.from_mesh(vertices**2, faces)


def scores(surface: Surface, candidate: NDArray[np.int64], reference: NDArray[np.int64]) -> Scores:
    return evaluate(surface, Segmentation.of(surface, candidate), Segmentation.of(surface, reference))


def values(score: Scores, metrics: tuple[str, ...] = METRICS) -> list[float]:
    return [getattr(score, metric) for metric in metrics]


def segment_sets(labels: NDArray[np.int64]) -> list[set[int]]:
    return [set(np.flatnonzero(labels == label).tolist()) for label in np.unique(labels)]


@given(labels_of_faces)
@repeatable
def test_equal_segmentations_score_zero(labels: NDArray[np.int64]) -> None:
    score = scores(uneven_surface(), labels, labels)
    undefined = len(np.unique(labels)) == 1
    assert math.isnan(score.cut_discrepancy) == undefined
    assert values(score, METRICS[1:]) == pytest.approx([0.0] * len(METRICS[1:]), abs=1e-12)
    assert undefined or score.cut_discrepancy == 0


@given(labels_of_faces, labels_of_faces, st.permutations(range(7)))
@repeatable
def test_scores_do_not_depend_on_the_names_of_labels(
    candidate: NDArray[np.int64], reference: NDArray[np.int64], names: list[int]
) -> None:
    renamed = np.array(names)[candidate + 2] * 1000 - 3
    expected = values(scores(uneven_surface(), candidate, reference))
    assert values(scores(uneven_surface(), renamed, reference)) == pytest.approx(expected, abs=1e-12, nan_ok=True)


@given(labels_of_faces, labels_of_faces)
@repeatable
def test_exchanging_the_two_exchanges_only_missing_and_false_alarm(
    candidate: NDArray[np.int64], reference: NDArray[np.int64]
) -> None:
    one, other = (scores(uneven_surface(), *pair) for pair in [(candidate, reference), (reference, candidate)])
    assert values(one, SYMMETRIC) == pytest.approx(values(other, SYMMETRIC), abs=1e-12, nan_ok=True)
    assert (one.missing_rate, one.false_alarm_rate) == pytest.approx((other.false_alarm_rate, other.missing_rate))


@given(labels_of_faces, labels_of_faces)
@repeatable
def test_the_rand_index_counts_pairs_of_faces(candidate: NDArray[np.int64], reference: NDArray[np.int64]) -> None:
    disagreeing = sum(
        (candidate[i] == candidate[j]) != (reference[i] == reference[j]) for i, j in combinations(range(FACES), 2)
    )
    assert scores(SURFACE, candidate, reference).one_minus_rand == pytest.approx(2 * disagreeing / FACES / (FACES - 2))


@given(labels_of_faces, labels_of_faces)
@repeatable
def test_the_hamming_distance_is_the_area_outside_the_best_match(
    candidate: NDArray[np.int64], reference: NDArray[np.int64]
) -> None:
    surface = uneven_surface()

    def area(faces: set[int]) -> float:
        return float(surface.face_area[sorted(faces)].sum())

    def rate(some: NDArray[np.int64], other: NDArray[np.int64]) -> float:
        outside = [min(area(s - o) for o in segment_sets(other)) for s in segment_sets(some)]
        return sum(outside) / area(set(range(FACES)))

    score = scores(surface, candidate, reference)
    assert score.missing_rate == pytest.approx(rate(reference, candidate), abs=1e-12)
    assert score.false_alarm_rate == pytest.approx(rate(candidate, reference), abs=1e-12)
    assert score.hamming == (score.missing_rate + score.false_alarm_rate) / 2


@given(labels_of_faces, labels_of_faces, st.booleans())
@repeatable
def test_the_consistency_error_is_a_mean_over_faces(
    candidate: NDArray[np.int64], reference: NDArray[np.int64], by_face: bool
) -> None:
    surface = uneven_surface()
    weight = np.ones(FACES) if by_face else surface.face_area

    def errors(some: NDArray[np.int64], other: NDArray[np.int64]) -> NDArray[np.float64]:
        inside = [some == some[face] for face in range(FACES)]
        return np.array([weight[s & (other != other[f])].sum() / weight[s].sum() for f, s in enumerate(inside)])

    one, other = errors(candidate, reference), errors(reference, candidate)
    score = scores(surface, candidate, reference)
    found = (score.gce_by_face, score.lce_by_face) if by_face else (score.gce, score.lce)
    assert found == pytest.approx((min(one.mean(), other.mean()), np.minimum(one, other).mean()), abs=1e-12)


@given(labels_of_faces, st.integers(1, FACES - 1))
@repeatable
def test_a_refinement_has_no_consistency_error_and_misses_only_one_way(labels: NDArray[np.int64], first: int) -> None:
    refined = 2 * labels + (np.arange(FACES) < first)
    score = scores(uneven_surface(), labels, refined)
    assert (score.gce, score.lce, score.gce_by_face, score.lce_by_face) == pytest.approx((0, 0, 0, 0), abs=1e-12)
    assert score.missing_rate == pytest.approx(0, abs=1e-12)


def test_scores_of_two_halves_against_the_whole() -> None:
    whole, halves = np.zeros(2 * 4, dtype=int), cut_at(4, 2)
    score = scores(strip_surface(4), whole, halves)
    assert score.missing_rate == pytest.approx(0)
    assert score.false_alarm_rate == pytest.approx(0.5)
    assert score.one_minus_rand == pytest.approx(2 * 4 * 4 / (8 * 6))


def test_the_cut_discrepancy_of_two_parallel_cuts_is_their_distance() -> None:
    surface = strip_surface(8, rows=3)
    score = scores(surface, cut_at(8, 2, rows=3), cut_at(8, 5, rows=3))
    assert score.cut_discrepancy == pytest.approx(3 / surface.mean_radius)


def test_the_cut_discrepancy_is_one_mean_over_the_cut_vertices_of_both() -> None:
    surface = strip_surface(8)
    score = scores(surface, cut_at(8, 2), cut_at(8, 2, 6))
    # Every cut has two vertices: those at 6 have distance 4 to the other cut, the other four are on it.
    assert score.cut_discrepancy == pytest.approx((2 * 4 / 6) / surface.mean_radius)


def test_cut_distances_run_along_the_edges_of_the_surface() -> None:
    vertices, faces = strip(8)
    angle = np.pi * vertices[:, 0] / 8
    bent = np.column_stack([np.cos(angle), vertices[:, 1], np.sin(angle)])
    surface = Surface.from_mesh(bent, faces)
    chord = 2 * math.sin(math.pi / 16)
    score = scores(surface, cut_at(8, 1), cut_at(8, 7))
    assert score.cut_discrepancy == pytest.approx(6 * chord / surface.mean_radius)


def test_the_mean_radius_is_weighted_by_area() -> None:
    surface = uneven_surface()
    vertices, faces = strip(COLUMNS, ROWS)
    centre = (vertices**2)[faces].mean(axis=1)
    share = surface.face_area / surface.face_area.sum()
    centroid = share @ centre
    assert surface.mean_radius == pytest.approx(share @ np.linalg.norm(centre - centroid, axis=1))


@given(labels_of_faces, labels_of_faces)
@repeatable
def test_scores_do_not_change_with_the_unit_of_length(
    candidate: NDArray[np.int64], reference: NDArray[np.int64]
) -> None:
    vertices, faces = strip(COLUMNS, ROWS)
    large = Surface.from_mesh(1000 * vertices + 7, faces)
    expected = values(scores(SURFACE, candidate, reference))
    assert values(scores(large, candidate, reference)) == pytest.approx(expected, abs=1e-9, nan_ok=True)


def test_the_cut_discrepancy_is_undefined_if_one_segmentation_has_no_cut() -> None:
    score = scores(strip_surface(4), cut_at(4), cut_at(4, 2))
    assert math.isnan(score.cut_discrepancy)
    assert not any(math.isnan(value) for value in values(score, METRICS[1:]))


def test_the_cut_discrepancy_is_undefined_between_cuts_on_different_components() -> None:
    vertices, faces = strip(4)
    both = Surface.from_mesh(
        np.vstack([vertices, vertices + np.array([0, 5, 0])]), np.vstack([faces, faces + len(vertices)])
    )
    cut, whole = cut_at(4, 2), cut_at(4) + 9
    score = scores(both, np.concatenate([cut, whole]), np.concatenate([whole, cut]))
    assert math.isnan(score.cut_discrepancy)


def test_means_leave_out_undefined_values_only() -> None:
    defined, undefined = Scores(*[0.2] * len(METRICS)), Scores(math.nan, *[0.4] * (len(METRICS) - 1))
    mean = mean_scores([defined, undefined])
    assert mean.cut_discrepancy == pytest.approx(0.2)
    assert mean.hamming == pytest.approx(0.3)
    assert math.isnan(mean_scores([undefined]).cut_discrepancy)


def test_a_cut_at_an_edge_of_three_faces_is_found() -> None:
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]], dtype=float)
    surface = Surface.from_mesh(vertices, np.array([[0, 1, 2], [0, 1, 3], [1, 0, 4]], dtype=np.int32))
    for labels in ([1, 0, 0], [0, 1, 0], [0, 0, 1]):
        assert Segmentation.of(surface, labels).cut_vertices.tolist() == [0, 1]


def test_an_edge_of_no_length_joins_its_ends() -> None:
    vertices, faces = strip(4)
    vertices[vertices[:, 0] >= 3, 0] -= 1
    surface = Surface.from_mesh(vertices, faces)
    assert scores(surface, cut_at(4, 2), cut_at(4, 3)).cut_discrepancy == 0


def test_invalid_surfaces_and_labels_are_rejected() -> None:
    vertices, faces = strip(2)
    with pytest.raises(ValueError, match="no area"):
        Surface.from_mesh(0 * vertices, faces)
    with pytest.raises(ValueError, match="one label for each of 4 faces"):
        Segmentation.of(Surface.from_mesh(vertices, faces), [0, 1, 2])
    with pytest.raises(ValueError, match="at least 3 faces"):
        scores(strip_surface(1), np.array([0, 1]), np.array([0, 0]))
