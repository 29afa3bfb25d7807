from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from helpers.graphs import grid, is_connected
from helpers.trees import grown_tree, leaves_below, members
from segcore.graphs.tree import Tree

GRID = grid(6, 8)
trees = st.builds(grown_tree, st.just(GRID), st.integers(1, 20), st.integers(0, 1000))


@given(trees)
def test_the_leaves_of_every_node_have_consecutive_places(tree: Tree) -> None:
    places = tree.leaf_intervals()
    for node, leaves in enumerate(leaves_below(tree)):
        assert sorted(places.first[list(leaves)]) == list(range(places.first[node], places.end[node]))


@given(trees)
def test_the_places_of_the_first_child_come_first(tree: Tree) -> None:
    places = tree.leaf_intervals()
    for split, node in enumerate(tree.split_node):
        assert places.first[node] == places.first[2 * split + 1]
        assert places.end[2 * split + 1] == places.first[2 * split + 2]


@given(trees)
def test_reordering_keeps_the_parts(tree: Tree) -> None:
    """Depth first in place of the given order: a parent still comes before its children."""
    order, waiting = [], [0] if len(tree.split_node) else []
    split_of = {int(node): split for split, node in enumerate(tree.split_node)}
    while waiting:
        split = split_of[waiting.pop()]
        order.append(split)
        waiting += [child for child in (2 * split + 1, 2 * split + 2) if child in split_of]
    tree = replace(tree, step=np.arange(len(tree.split_node), dtype=np.int32) // 2, limit_reached=True)
    reordered = tree.reordered(order, 1)
    pairs = [(order[i] // 2 == order[j] // 2) == (reordered.step[i] == reordered.step[j]) for i in order for j in order]
    assert all(pairs)
    assert list(dict.fromkeys(reordered.step.tolist())) == list(range((len(order) + 1) // 2))
    assert reordered.limit_reached
    assert {part.tobytes() for part in members(reordered)} == {part.tobytes() for part in members(tree)}
    assert (reordered.split_node <= 2 * np.arange(len(order))).all()


def test_reordering_numbers_the_steps_in_the_new_order() -> None:
    """Splits 1 and 2 are one step, which now comes after that of split 3."""
    leaf = np.arange(5, 9, dtype=np.int32)
    tree = Tree(np.array([0, 1, 3, 2], dtype=np.int32), np.arange(4.0), leaf, 1, np.array([0, 1, 1, 2], dtype=np.int32))
    reordered = tree.reordered([0, 3, 1, 2], 2)
    np.testing.assert_array_equal(reordered.step, [0, 1, 2, 2])
    np.testing.assert_array_equal(reordered.cut_value, [0, 3, 1, 2])
    plain = Tree(tree.split_node, tree.cut_value, leaf, 1)
    np.testing.assert_array_equal(plain.step, np.arange(4))


@given(trees, st.integers(0, 1000))
def test_a_tree_is_connected_if_every_node_of_it_is(tree: Tree, seed: int) -> None:
    assert tree.is_connected(GRID)
    leaf = tree.leaf.copy()
    moved = np.random.default_rng(seed).integers(len(leaf))
    leaf[moved] = np.random.default_rng(seed + 1).choice(tree.leaf)
    changed = Tree(tree.split_node, tree.cut_value, leaf, 1)
    if len(np.unique(leaf)) == len(tree.split_node) + 1:
        assert changed.is_connected(GRID) == all(is_connected(GRID, part) for part in members(changed))
