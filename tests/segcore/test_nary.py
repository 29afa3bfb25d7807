"""The n-ary tree of steps: its nodes, its children, its levels."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.hierarchies import steps
from segcore.hierarchy import Hierarchy
from segcore.nary import joined_splits, nary_children, numbered_steps, own_steps


@st.composite
def trees(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    """The split nodes of a tree of up to 15 leaves, and the steps of the splits."""
    leaves, split_node = [0], []
    for split in range(draw(st.integers(0, 14))):
        split_node.append(leaves.pop(draw(st.integers(0, len(leaves) - 1))))
        leaves += [2 * split + 1, 2 * split + 2]
    return np.array(split_node, np.int32), draw(steps(split_node))


def hierarchy_of(split_node: list[int], step: list[int]) -> Hierarchy:
    nodes = 2 * len(split_node) + 1
    leaves = np.setdiff1d(np.arange(nodes), split_node).astype(np.int32)
    return Hierarchy(
        np.array(split_node, np.int32),
        np.ones(len(split_node)),
        np.ones(nodes),
        np.ones(nodes, np.int32),
        leaves,
        1,
        np.array(step, np.int32),
    )


def test_four_legs_are_siblings_of_the_body() -> None:
    """Split s cuts a leg, node 2 s + 2, off the body; then the body is cut into two other parts."""
    table = hierarchy_of([0, 1, 3, 5, 7], [0, 0, 0, 0, 1])
    children = table.nary_children
    assert children[0] == [7, 2, 4, 6, 8]
    assert children[7] == [9, 10]
    assert [node for node, below in enumerate(children) if below] == [0, 7]
    assert table.step_ends.tolist() == [1, 5, 6]


def test_a_chain_that_is_halved_is_one_node() -> None:
    chain = hierarchy_of([0, 1, 2], [0, 0, 0])
    assert chain.nary_children[0] == [3, 5, 4, 6], "in the order of the labels 0, 1, 2, 3"
    assert chain.label[[3, 5, 4, 6]].tolist() == [0, 1, 2, 3]


def test_splits_of_one_step_in_different_branches_share_the_level_alone() -> None:
    """Body, arm, arm; then both arms are cut at the elbow."""
    person = hierarchy_of([0, 1, 2, 4], [0, 0, 1, 1])
    assert person.nary_children[0] == [3, 2, 4]
    assert person.nary_children[2] == [5, 6]
    assert person.nary_children[4] == [7, 8]
    assert person.step_ends.tolist() == [1, 3, 5]


def test_a_step_that_is_interrupted_ends_with_its_last_split() -> None:
    assert hierarchy_of([0, 1, 2], [0, 1, 0]).step_ends.tolist() == [1, 3, 4]


@given(trees())
def test_without_common_steps_the_tree_is_binary(tree: tuple[np.ndarray, np.ndarray]) -> None:
    split_node, _ = tree
    children = nary_children(split_node, own_steps(len(split_node)))
    expected: list[list[int]] = [[] for _ in children]
    for split, node in enumerate(split_node.tolist()):
        expected[node] = [2 * split + 1, 2 * split + 2]
    assert children == expected


@given(trees())
def test_the_children_are_the_leaves_of_the_largest_subtree_of_one_step(tree: tuple[np.ndarray, np.ndarray]) -> None:
    split_node, step = tree
    split_of = {int(node): split for split, node in enumerate(split_node)}

    def frontier(node: int, of: int) -> set[int]:
        split = split_of.get(node)
        if split is None or step[split] != of:
            return {node}
        return frontier(2 * split + 1, of) | frontier(2 * split + 2, of)

    children = nary_children(split_node, step)
    passed_over = set(split_node[joined_splits(split_node, step)].tolist())
    for node, split in split_of.items():
        expected = set() if node in passed_over else frontier(node, int(step[split]))
        assert set(children[node]) == expected
    below = sorted(child for nodes in children for child in nodes)
    assert below == sorted(set(range(1, len(children))) - passed_over), "every node that is shown has one parent"


@given(trees())
def test_children_are_in_the_order_of_their_labels_and_the_first_has_that_of_its_parent(
    tree: tuple[np.ndarray, np.ndarray],
) -> None:
    hierarchy = hierarchy_of(tree[0].tolist(), tree[1].tolist())
    label = hierarchy.label
    for node, below in enumerate(hierarchy.nary_children):
        labels = label[below].tolist()
        assert labels == sorted(set(labels))
        assert not below or labels[0] == label[node]


@given(trees())
def test_at_the_end_of_a_step_no_step_that_has_just_begun_is_left_in_part(tree: tuple[np.ndarray, np.ndarray]) -> None:
    hierarchy = hierarchy_of(tree[0].tolist(), tree[1].tolist())
    ends = hierarchy.step_ends.tolist()
    assert ends == sorted(set(ends))
    assert (ends[0], ends[-1]) == (1, hierarchy.max_segments)
    for segments in range(2, hierarchy.max_segments + 1):
        last, later = tree[1][segments - 2], tree[1][segments - 1 :]
        assert (segments in ends) == (last not in later)


@given(st.lists(st.integers(0, 5), max_size=12))
def test_steps_are_numbered_by_their_first_splits(step: list[int]) -> None:
    numbered = numbered_steps(np.array(step, np.int32)).tolist()
    assert [a == b for a in step for b in step] == [a == b for a in numbered for b in numbered]
    assert list(dict.fromkeys(numbered)) == list(range(len(set(step))))
