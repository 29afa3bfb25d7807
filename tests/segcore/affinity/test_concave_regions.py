from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from segcore import shapes
from segcore.affinity.concave_regions import (
    DEEP,
    cleaned_up,
    concave_vertices,
    mahalanobis,
    region_statistics,
    z_scores,
)
from segcore.affinity.curvature import PrincipalCurvatures, principal_curvatures
from segcore.clean.topology import mesh_edges
from segcore.graphs.surface_graph import rows_of

BURR = shapes.burr(5).mesh
CURVATURES = principal_curvatures(BURR.vertices, BURR.faces)
EDGES = mesh_edges(BURR.faces)
ROWS = rows_of(EDGES, len(BURR.vertices))


def path_rows(count):
    """The neighbours of the nodes of a path."""
    return rows_of(np.array([(i, i + 1) for i in range(count - 1)], np.int32).reshape(-1, 2), count)


def test_z_scores_have_mean_0_and_deviation_1():
    scores = z_scores(np.array([1.0, 2, 4, 9]))
    assert scores.mean() == pytest.approx(0)
    assert scores.std() == pytest.approx(1)


def test_equal_values_have_z_score_0():
    np.testing.assert_array_equal(z_scores(np.full(5, 3.0)), np.zeros(5))


def test_without_thinning_every_vertex_below_the_threshold_is_concave():
    np.testing.assert_array_equal(concave_vertices(CURVATURES, ROWS, "none"), z_scores(CURVATURES.k2) < DEEP)


@pytest.mark.parametrize("thinning", ["walk", "revisit"])
def test_thinning_only_removes_vertices(thinning):
    thick, thin = (concave_vertices(CURVATURES, ROWS, choice) for choice in ("none", thinning))
    assert not (thin & ~thick).any()
    assert 0 < thin.sum() < thick.sum()


def test_walked_paths_are_thin():
    """The ring at the foot of an arm is several vertices wide; few vertices of its paths have a third neighbour."""
    thick, thin = (concave_vertices(CURVATURES, ROWS, choice) for choice in ("none", "walk"))
    neighbours = {choice: np.array([(concave & np.isin(np.arange(len(concave)), ROWS.neighbour[a:b])).sum()
                                    for a, b, own in zip(ROWS.start, ROWS.start[1:], concave, strict=False) if own])
                  for choice, concave in (("thick", thick), ("thin", thin))}  # fmt: skip
    assert neighbours["thick"].mean() > 3.5
    assert neighbours["thin"].mean() < 2.5


def test_walked_paths_still_run_around_the_foot_of_every_arm():
    thin = concave_vertices(CURVATURES, ROWS, "walk")
    for axis in range(3):
        for sign in (1, -1):
            across = np.delete(np.arange(3), axis)
            at_arm = thin & (sign * BURR.vertices[:, axis] > np.abs(BURR.vertices[:, across]).max(axis=1))
            angle = np.arctan2(*BURR.vertices[at_arm][:, across].T)
            assert np.histogram(angle, 12, (-np.pi, np.pi))[0].min() > 0


def test_a_walk_along_a_ridge_keeps_it_whole():
    k2 = np.where(np.arange(30) < 10, -1.0, 1.0)
    concave = concave_vertices(PrincipalCurvatures(k1=np.zeros(30), k2=k2), path_rows(30), "walk")
    np.testing.assert_array_equal(concave, k2 < 0)


def test_short_and_shallow_paths_are_removed_and_deep_ones_are_kept():
    concave = np.array([1, 1, 0, 1, 0, 1, 1, 1, 0], bool)
    z = np.where(concave, -1.0, 0.0)
    z[3] = -2.5
    kept = cleaned_up(concave, z, path_rows(9))
    np.testing.assert_array_equal(np.flatnonzero(kept), [3, 5, 6, 7])


@given(st.integers(0, 1000))
def test_the_distance_of_two_regions_is_that_of_the_formula(seed):
    rng = np.random.default_rng(seed)
    k1, k2 = rng.normal(size=(2, 5))
    rows = path_rows(5)
    statistics = region_statistics(k1, k2, rows)
    regions = [np.stack([k1, k2])[:, max(0, v - 1) : v + 2] for v in range(5)]
    pooled = (np.cov(regions[1], bias=True) + np.cov(regions[2], bias=True)) / 2
    difference = regions[1].mean(axis=1) - regions[2].mean(axis=1)
    expected = difference @ np.linalg.solve(pooled + 1e-6 * np.diag([k1.var(), k2.var()]), difference)
    assert mahalanobis(1, 2, statistics) == pytest.approx(expected, rel=1e-6)


def walked(thinning):
    """The thinned regions of the burr before the clean-up, in plain Python after the words of the paper."""
    z = z_scores(CURVATURES.k2)
    statistics = region_statistics(CURVATURES.k1, CURVATURES.k2, ROWS)
    neighbours = [ROWS.neighbour[a:b].tolist() for a, b in pairwise(ROWS.start)]
    is_open = dict(enumerate((z < DEEP).tolist()))
    visits = dict.fromkeys(is_open, 0)
    for seed in np.argsort(z, kind="stable").tolist():
        here = seed if is_open[seed] else None
        while here is not None:
            visits[here] += 1
            is_open[here] = is_open[here] and thinning == "revisit" and visits[here] < 2
            candidates = [v for v in neighbours[here] if is_open[v]]
            if thinning == "revisit" and visits[here] == 2:
                is_open.update((v, False) for v in neighbours[here] if visits[v] == 0)
                candidates = [v for v in neighbours[here] if is_open[v]]
            ahead = min(candidates, key=lambda v: mahalanobis(here, v, statistics), default=None)
            if thinning == "walk":
                is_open.update((v, False) for v in neighbours[here] if v != ahead)
            here = ahead
    return cleaned_up(np.array([visits[v] > 0 for v in range(len(z))]), z, ROWS)


@pytest.mark.parametrize("thinning", ["walk", "revisit"])
def test_walks_are_those_of_plain_python(thinning):
    np.testing.assert_array_equal(concave_vertices(CURVATURES, ROWS, thinning), walked(thinning))
