"""The agreement of segments with parts, against values by hand and by counting pairs."""

import numpy as np
import pytest

from bench.assets.dataset import NO_PART
from bench.assets.metrics import Reference, mean_iou, one_minus_rand, rand_of_levels
from helpers.hierarchies import hierarchy_of
from helpers.trees import grown_tree
from segcore.graphs.surface_graph import SurfaceGraph


def reference(part: list[int], area: list[float]) -> Reference:
    return Reference(np.array(part, dtype=np.int64), np.array(area, dtype=np.float64))


def path_graph(count: int) -> SurfaceGraph:
    ones = np.ones(count - 1)
    edges = np.column_stack([np.arange(count - 1), np.arange(1, count)]).astype(np.int32)
    return SurfaceGraph(edges, ones, np.ones(count), ones)


def test_one_minus_rand_is_the_share_of_the_pairs_of_points_that_disagree() -> None:
    rng = np.random.default_rng(0)
    part, label, area = rng.integers(-1, 4, 30), rng.integers(0, 5, 30), rng.integers(1, 6, 30)
    counted = np.flatnonzero(part != NO_PART)
    points = np.repeat(counted, area[counted])  # one for every unit of area
    together, kept = (values[points, None] == values[points] for values in (label, part))
    shared = reference(part.tolist(), area.tolist()).shared_areas(label)
    assert one_minus_rand(shared) == pytest.approx(np.mean(together != kept))


def test_faces_without_a_part_do_not_count() -> None:
    cut = reference([0, 0, 1, NO_PART], [1, 2, 3, 9])
    for label in ([0, 0, 1, 0], [0, 0, 1, 1], [0, 0, 1, 2]):
        shared = cut.shared_areas(np.array(label))
        assert (one_minus_rand(shared), mean_iou(shared)) == (0.0, 1.0)
    assert one_minus_rand(cut.shared_areas(np.zeros(4, dtype=np.int64))) == pytest.approx(2 * 3 * 3 / 36)


def test_dividing_a_face_changes_nothing() -> None:
    whole = reference([0, 0, 1], [2, 4, 6]).shared_areas(np.array([0, 1, 1]))
    divided = reference([0, 0, 0, 1, 1], [2, 1, 3, 2, 4]).shared_areas(np.array([0, 1, 1, 1, 1]))
    assert np.array_equal(whole, divided)
    assert one_minus_rand(whole) == pytest.approx(2 * (2 * 4 + 4 * 6) / 144)


def test_every_part_has_at_most_one_segment_and_every_segment_one_part() -> None:
    # Part 0 is in two segments, parts 1 and 2 are in one segment.
    shared = np.array([[6.0, 0, 0], [2, 0, 0], [0, 5, 4]])
    assert mean_iou(shared) == pytest.approx((6 / 8 + 5 / 9 + 0) / 3)


def test_the_matching_has_the_largest_sum() -> None:
    # The best segment of both parts is segment 0; with part 0 it leaves 1/4 for part 1, with part 1 it leaves 4/9.
    shared = np.array([[5.0, 4], [4, 1]])
    assert mean_iou(shared) == pytest.approx((4 / 10 + 4 / 10) / 2)


def test_no_area_is_no_disagreement() -> None:
    empty = reference([NO_PART, 0, 1], [1, 0, 0]).shared_areas(np.array([0, 0, 1]))
    assert (one_minus_rand(empty), mean_iou(empty)) == (0.0, 0.0)


@pytest.mark.parametrize("seed", range(5))
def test_the_levels_of_a_hierarchy_score_as_their_labels_do(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tree = grown_tree(path_graph(60), 9, seed)
    hierarchy = hierarchy_of(tree.split_node.tolist(), tree.leaf, automatic=1)
    parts = Reference(np.sort(rng.integers(-1, 6, 60)), rng.uniform(0.1, 2, 60))
    expected = [one_minus_rand(parts.shared_areas(hierarchy.labels(k))) for k in range(1, 10)]
    assert rand_of_levels(hierarchy, parts).tolist() == pytest.approx(expected, rel=0, abs=1e-12)


def test_a_hierarchy_without_splits_has_one_level() -> None:
    parts = reference([0, 1], [1, 1])
    assert rand_of_levels(hierarchy_of([], np.zeros(2), automatic=1), parts).tolist() == [0.5]
