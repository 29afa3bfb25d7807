"""K-means clustering of the face centres."""

import numpy as np

from bench.peers.kmeans import KMeans, weighted_kmeans
from helpers.meshes import pieces_of_labels
from segcore.shapes import burr


def test_every_point_is_nearest_to_the_weighted_mean_of_its_cluster() -> None:
    rng = np.random.default_rng(5)
    points, weight = rng.normal(size=(400, 3)), rng.uniform(0.1, 3.0, 400)
    cluster = weighted_kmeans(points, weight, 6)
    means = np.array([np.average(points[cluster == c], axis=0, weights=weight[cluster == c]) for c in range(6)])
    distance = np.linalg.norm(points[:, None] - means, axis=2)
    assert np.array_equal(distance.argmin(axis=1), cluster)


def test_distant_groups_of_points_are_separated_with_any_weights() -> None:
    rng = np.random.default_rng(5)
    group = np.repeat(np.arange(4), (50, 5, 200, 1))
    points = rng.normal(size=(len(group), 3)) + 100 * np.eye(4, 3)[group]
    cluster = weighted_kmeans(points, rng.uniform(0.1, 3.0, len(group)), 4)
    assert len(np.unique(group * 4 + cluster)) == len(np.unique(cluster)) == 4


def test_the_segments_are_connected_and_have_the_given_number() -> None:
    mesh = burr(subdivisions=3).mesh
    for segments in (1, 2, 7):
        labels = KMeans()(mesh, segments).labels
        assert len(np.unique(labels)) == segments
        assert pieces_of_labels(mesh, labels) == segments
