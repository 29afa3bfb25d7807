import numpy as np

from segcore.components import follow_hosts, group_by_nearness


def blob(at, count, rng):
    return np.asarray(at, float) + 0.1 * rng.random((count, 3))


def test_the_nearest_components_are_grouped_first():
    rng = np.random.default_rng(0)
    points = np.concatenate([blob([0, 0, 0], 30, rng), blob([10, 0, 0], 5, rng), blob([1, 0, 0], 20, rng),
                             blob([12, 0, 0], 9, rng)])  # fmt: skip
    merges = group_by_nearness(points, np.repeat([0, 1, 2, 3], [30, 5, 20, 9]))
    np.testing.assert_array_equal(np.sort(merges, axis=1), [[0, 2], [1, 3], [4, 5]])


def test_one_component_has_nothing_to_group():
    assert group_by_nearness(np.zeros((4, 3)), np.zeros(4, int)).shape == (0, 2)


def test_more_components_than_samples_are_grouped_all():
    at = np.random.default_rng(1).random((1000, 3))
    merges = group_by_nearness(np.repeat(at, 3, axis=0), np.repeat(np.arange(1000), 3))
    assert sorted(merges.ravel()) == list(range(1998))


def test_few_components_all_stand_for_themselves():
    hosts, followed = follow_hosts(np.array([0, 1, 1, 2]), np.array([1.0, 1, 1, 1e-9]), np.zeros((4, 3)), 3)
    np.testing.assert_array_equal(hosts, [0, 1, 2, 3])
    np.testing.assert_array_equal(followed, [0, 1, 2, 3])


def test_of_many_components_the_negligible_follow_the_nearest_large_one():
    component = np.array([0, 1, 2, 3, 4])
    areas = np.array([1.0, 1e-6, 2.0, 1e-6, 1e-6])
    centroids = np.array([[0.0, 0, 0], [4, 0, 0], [5, 0, 0], [1, 0, 0], [9, 0, 0]])
    hosts, followed = follow_hosts(component, areas, centroids, 3)
    np.testing.assert_array_equal(hosts, [0, 2])
    np.testing.assert_array_equal(followed, [0, 1, 1, 0, 1])


def test_a_component_follows_as_a_whole():
    component = np.array([0, 1, 2, 2, 2])
    centroids = np.array([[0.0, 0, 0], [10, 0, 0], [3, 0, 0], [5, 0, 0], [8, 0, 0]])
    hosts, followed = follow_hosts(component, np.array([1.0, 1, 1e-6, 1e-6, 1e-6]), centroids, 2)
    np.testing.assert_array_equal(hosts, [0, 1])
    np.testing.assert_array_equal(followed, [0, 1, 1, 1, 1])


def test_a_dust_of_equal_components_keeps_the_number_asked_for():
    component = np.arange(5000)
    hosts, followed = follow_hosts(component, np.ones(5000), np.random.default_rng(2).random((5000, 3)), 32)
    assert len(hosts) == 1 or len(hosts) == 32
    assert followed.max() == len(hosts) - 1
