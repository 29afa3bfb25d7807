import numpy as np

from helpers.graphs import grid, path, weighted_graph
from segcore.symmetry.pieces import in_one_piece

ONE_KIND = np.zeros(4, dtype=np.int32)


def test_the_smaller_piece_of_a_group_joins_a_neighbour():
    group = np.array([0, 0, 0, 1, 1, 0, 2, 2], dtype=np.int32)
    graph = path(8)
    weight = np.ones(7)
    weight[5] = 2.0  # the border of the loose node 5 with group 2 is longer than that with group 1
    joined = in_one_piece(weighted_graph(graph.edges, weight, np.ones(8)), group, ONE_KIND[:3])
    np.testing.assert_array_equal(joined, [0, 0, 0, 1, 1, 2, 2, 2])


def test_a_piece_joins_no_group_of_another_kind():
    group = np.array([0, 0, 0, 1, 1, 0, 2, 2], dtype=np.int32)
    np.testing.assert_array_equal(in_one_piece(path(8), group, np.array([0, 0, 1], dtype=np.int32))[5], 1)
    np.testing.assert_array_equal(in_one_piece(path(8), group, np.array([0, 1, 1], dtype=np.int32)), group)


def test_connected_groups_stay():
    group = np.repeat(np.arange(4, dtype=np.int32), 5)
    np.testing.assert_array_equal(in_one_piece(grid(4, 5), group, ONE_KIND), group)
