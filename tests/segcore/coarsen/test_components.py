import numpy as np
from scipy.cluster.hierarchy import linkage

from segcore.coarsen.components import group_by_nearness, largest, nearest_hosts


def blob(at, count, rng):
    """Random points in a small box at a place."""
    return np.asarray(at, float) + 0.1 * rng.random((count, 3))


def test_the_nearest_components_are_grouped_first():
    rng = np.random.default_rng(0)
    points = np.concatenate([blob([0, 0, 0], 30, rng), blob([10, 0, 0], 5, rng), blob([1, 0, 0], 20, rng),
                             blob([12, 0, 0], 9, rng)])  # fmt: skip
    merges = group_by_nearness(points, np.repeat([0, 1, 2, 3], [30, 5, 20, 9]))
    np.testing.assert_array_equal(np.sort(merges, axis=1), [[0, 2], [1, 3], [4, 5]])


def test_one_component_has_nothing_to_group():
    assert group_by_nearness(np.zeros((4, 3)), np.zeros(4, int)).shape == (0, 2)


def test_more_components_than_samples_are_all_grouped():
    at = np.random.default_rng(1).random((1000, 3))
    merges = group_by_nearness(np.repeat(at, 3, axis=0), np.repeat(np.arange(1000), 3))
    assert sorted(merges.ravel()) == list(range(1998))


def test_the_largest_components_are_chosen_and_negligible_ones_are_not():
    component, areas = np.array([0, 1, 1, 2, 3]), np.array([1.0, 1, 1, 5, 0.001])
    np.testing.assert_array_equal(largest(component, areas, 9), [True, True, True, True])
    np.testing.assert_array_equal(largest(component, areas, 2), [False, True, True, False])
    np.testing.assert_array_equal(largest(component, areas, 9, 0.002), [True, True, True, False])


def test_of_many_components_of_nearly_equal_area_none_is_negligible():
    areas = np.random.default_rng(0).uniform(0.9, 1, 5000)
    assert largest(np.arange(5000), areas, 32, 0.002).sum() == 32


def test_every_component_that_is_not_a_host_gets_the_nearest_pair_of_points():
    component = np.array([0, 1, 2, 2, 2, 3])
    points = np.array([[0.0, 0, 0], [10, 0, 0], [3, 0, 0], [5, 0, 0], [8, 0, 0], [1, 0, 0]])
    pairs = nearest_hosts(component, np.array([True, True, False, False]), points)
    np.testing.assert_array_equal(pairs, [[4, 1], [5, 0]])


def test_there_are_no_pairs_if_all_components_are_hosts():
    assert nearest_hosts(np.array([0, 1]), np.array([True, True]), np.eye(3)[:2]).shape == (0, 2)


def test_many_components_are_grouped_as_by_single_linkage():
    at = np.random.default_rng(2).random((2100, 3))
    np.testing.assert_array_equal(
        np.sort(group_by_nearness(at, np.arange(2100)), axis=1),
        np.sort(linkage(at, "single")[:, :2].astype(int), axis=1),
    )
