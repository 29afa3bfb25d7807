import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy


@st.composite
def hierarchies(draw):
    """Random trees: each split cuts a random one of the current leaves."""
    splits = draw(st.integers(0, 12))
    leaves, split_node = [0], []
    for s in range(splits):
        node = leaves.pop(draw(st.integers(0, len(leaves) - 1)))
        split_node.append(node)
        leaves += [2 * s + 1, 2 * s + 2]
    face_leaf = np.array(leaves + draw(st.lists(st.sampled_from(leaves), max_size=20)), np.int32)
    nodes = 2 * splits + 1
    return Hierarchy(
        split_node=np.array(split_node, np.int32),
        cut_value=np.zeros(splits),
        area=np.ones(nodes),
        face_count=np.ones(nodes, np.int32),
        face_leaf=face_leaf,
        automatic_segments=draw(st.integers(1, splits + 1)),
    )


@given(hierarchies())
def test_labels_at_k_segments_are_exactly_0_to_k_minus_1(hierarchy):
    for k in range(1, hierarchy.max_segments + 1):
        labels = hierarchy.labels(k)
        assert labels.dtype == np.int32
        np.testing.assert_array_equal(np.unique(labels), np.arange(k))


@given(hierarchies())
def test_finer_levels_refine_coarser_ones_and_only_the_new_label_differs(hierarchy):
    for k in range(2, hierarchy.max_segments + 1):
        coarse, fine = hierarchy.labels(k - 1), hierarchy.labels(k)
        moved = coarse != fine
        assert set(fine[moved]) == {k - 1}
        assert len(set(coarse[moved])) == 1


@given(hierarchies())
def test_the_segment_nodes_contain_the_faces_with_their_labels(hierarchy):
    parent = hierarchy.parent
    for k in range(1, hierarchy.max_segments + 1):
        nodes = hierarchy.segment_nodes(k)
        for face, leaf in enumerate(hierarchy.face_leaf):
            ancestors = [leaf]
            while ancestors[-1] != 0:
                ancestors.append(parent[ancestors[-1]])
            assert nodes[hierarchy.labels(k)[face]] in ancestors


@given(hierarchies())
def test_children_parents_and_levels_are_of_the_same_tree(hierarchy):
    for node, pair in enumerate(hierarchy.children):
        for child in pair[pair >= 0]:
            assert hierarchy.parent[child] == node
            assert hierarchy.level[child] > hierarchy.level[node]
            assert child in hierarchy.segment_nodes(int(hierarchy.level[child]))
            assert child not in hierarchy.segment_nodes(int(hierarchy.level[child]) - 1)


@given(hierarchies())
def test_the_default_number_of_segments_is_the_automatic_one(hierarchy):
    np.testing.assert_array_equal(hierarchy.labels(), hierarchy.labels(hierarchy.automatic_segments))


@given(hierarchies(), st.sampled_from([-1, 0, 1000]))
def test_a_number_of_segments_outside_the_tree_is_refused_with_the_range(hierarchy, segments):
    with pytest.raises(InvalidParameters, match=rf"from 1 to {hierarchy.max_segments} .*not {segments}"):
        hierarchy.labels(segments)


@given(hierarchies(), st.floats(0, 1), st.floats(0, 1))
def test_finer_granularity_never_gives_fewer_segments(hierarchy, one, other):
    low, high = sorted((one, other))
    assert hierarchy.segments_at(low) <= hierarchy.segments_at(high)
    assert hierarchy.segments_at(0) == 1
    assert hierarchy.segments_at(0.5) == hierarchy.automatic_segments
    assert hierarchy.segments_at(1) == hierarchy.max_segments


@pytest.mark.parametrize("granularity", [-0.01, 1.01, float("nan")])
def test_a_granularity_outside_0_to_1_is_refused(granularity):
    whole = Hierarchy(np.zeros(0, np.int32), np.zeros(0), np.ones(1), np.ones(1, np.int32), np.zeros(1, np.int32), 1)
    with pytest.raises(InvalidParameters, match="from 0"):
        whole.segments_at(granularity)
