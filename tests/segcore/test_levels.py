"""Requested numbers of segments, and splits that are moved to the front of a hierarchy."""

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.hierarchies import steps
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.levels import Fineness, keep_splits


@st.composite
def hierarchies(draw: st.DrawFn) -> Hierarchy:
    """Trees of up to eleven leaves, each of one face."""
    count = draw(st.integers(0, 10))
    split_node: list[int] = []
    leaves = [0]
    for split in range(count):
        node = draw(st.sampled_from(leaves))
        leaves.remove(node)
        leaves += [2 * split + 1, 2 * split + 2]
        split_node.append(node)
    size = np.zeros(2 * count + 1, dtype=np.int32)
    size[leaves] = 1
    for split in reversed(range(count)):
        size[split_node[split]] = size[2 * split + 1] + size[2 * split + 2]
    return Hierarchy(
        split_node=np.array(split_node, dtype=np.int32),
        cut_value=np.arange(count) + 0.5,
        area=size * 2.0,
        face_count=size,
        face_leaf=np.array(sorted(leaves), dtype=np.int32),
        automatic_segments=count + 1,
        step=draw(steps(split_node)),
        limit_reached=draw(st.booleans()),
    )


@st.composite
def closed_choices(draw: st.DrawFn) -> tuple[Hierarchy, set[int]]:
    """A tree and some of its splits, each with the splits above it."""
    hierarchy = draw(hierarchies())
    wanted = draw(st.sets(st.integers(0, hierarchy.max_segments - 2))) if hierarchy.max_segments > 1 else set()
    closed = set()
    for split in wanted:
        at: int = split
        while at >= 0:
            closed.add(at)
            at = (int(hierarchy.split_node[at]) - 1) // 2
    return hierarchy, closed


@given(hierarchies())
def test_the_automatic_number_is_meant_if_nothing_is_given(hierarchy: Hierarchy) -> None:
    assert Fineness().is_automatic
    assert Fineness().segments_of(hierarchy) == hierarchy.automatic_segments


@given(hierarchies(), st.floats(0, 1), st.data())
def test_a_number_or_a_granularity_selects_the_level(
    hierarchy: Hierarchy, granularity: float, data: st.DataObject
) -> None:
    segments = data.draw(st.integers(1, hierarchy.max_segments))
    assert Fineness(segments=segments).segments_of(hierarchy) == segments
    assert Fineness(granularity=granularity).segments_of(hierarchy) == hierarchy.segments_at(granularity)
    assert not Fineness(segments=segments).is_automatic
    assert not Fineness(granularity=granularity).is_automatic


def test_a_number_and_a_granularity_together_are_refused() -> None:
    with pytest.raises(InvalidParameters, match="either segments or granularity"):
        Fineness(segments=3, granularity=0.5)


@given(hierarchies())
def test_a_number_outside_the_hierarchy_is_refused(hierarchy: Hierarchy) -> None:
    with pytest.raises(InvalidParameters, match=f"from 1 to {hierarchy.max_segments} "):
        Fineness(segments=hierarchy.max_segments + 1).segments_of(hierarchy)


@given(closed_choices())
def test_exactly_the_kept_splits_separate_faces(choice: tuple[Hierarchy, set[int]]) -> None:
    hierarchy, splits = choice
    kept = keep_splits(hierarchy, splits)
    labels = kept.labels()
    assert sorted(set(labels.tolist())) == list(range(len(splits) + 1))
    for i, a in enumerate(hierarchy.face_leaf.tolist()):
        for j, b in enumerate(hierarchy.face_leaf.tolist()):
            assert (labels[i] != labels[j]) == (_separated_by(hierarchy, a, b) in splits)


@given(closed_choices())
def test_nodes_keep_their_faces_areas_and_cut_values(choice: tuple[Hierarchy, set[int]]) -> None:
    hierarchy, splits = choice
    kept = keep_splits(hierarchy, splits)
    assert _facts(kept) == _facts(hierarchy)
    assert kept.max_segments == hierarchy.max_segments
    assert (kept.split_node <= 2 * np.arange(len(kept.split_node))).all()


@given(hierarchies(), st.integers(0, 10))
def test_keeping_the_first_splits_changes_nothing_but_the_automatic_number(hierarchy: Hierarchy, count: int) -> None:
    count = min(count, hierarchy.max_segments - 1)
    kept = keep_splits(hierarchy, range(count))
    assert kept.automatic_segments == count + 1
    for name in {field.name for field in fields(Hierarchy)} - {"automatic_segments", "step"}:
        np.testing.assert_array_equal(getattr(kept, name), getattr(hierarchy, name))


@given(closed_choices())
def test_steps_that_are_kept_or_left_as_a_whole_stay_and_others_fall_in_two(choice: tuple[Hierarchy, set[int]]) -> None:
    hierarchy, splits = choice
    kept = keep_splits(hierarchy, splits)
    order = [*sorted(splits), *sorted(set(range(hierarchy.max_segments - 1)) - splits)]
    for i, a in enumerate(order):
        for j, b in enumerate(order):
            expected = hierarchy.step[a] == hierarchy.step[b] and (a in splits) == (b in splits)
            assert (kept.step[i] == kept.step[j]) == expected
    assert list(dict.fromkeys(kept.step.tolist())) == list(range(len(set(kept.step.tolist()))))


@pytest.fixture
def chain() -> Hierarchy:
    """Node 0 is cut into 1 and 2, then node 1 into 3 and 4."""
    return Hierarchy(
        split_node=np.array([0, 1], dtype=np.int32),
        cut_value=np.array([0.1, 0.2]),
        area=np.array([3.0, 2.0, 1.0, 1.0, 1.0]),
        face_count=np.array([3, 2, 1, 1, 1], dtype=np.int32),
        face_leaf=np.array([2, 3, 4], dtype=np.int32),
        automatic_segments=2,
    )


@pytest.mark.parametrize(
    ("splits", "message"),
    [([1], "Split 1 cuts a part that split 0 makes"), ([0, 2], "there is no split 2"), ([-1], "there is no split -1")],
)
def test_splits_that_cannot_be_made_are_refused(chain: Hierarchy, splits: list[int], message: str) -> None:
    with pytest.raises(InvalidParameters, match=message):
        keep_splits(chain, splits)


def _separated_by(hierarchy: Hierarchy, a: int, b: int) -> int:
    """The split that puts two leaves into different parts; -1 if they are the same."""
    if a == b:
        return -1
    above_a = _path(hierarchy, a)
    below, node = b, int(hierarchy.parent[b])
    while node not in above_a:
        below, node = node, int(hierarchy.parent[node])
    return (below - 1) // 2


def _path(hierarchy: Hierarchy, node: int) -> set[int]:
    """A node and all nodes above it."""
    path = set()
    while node >= 0:
        path.add(node)
        node = int(hierarchy.parent[node])
    return path


def _facts(hierarchy: Hierarchy) -> set[tuple[frozenset[int], float, int, float]]:
    """The faces, area, number of faces and cut value of every node, independent of the numbers of the nodes."""
    cut_value = dict(zip(hierarchy.split_node.tolist(), hierarchy.cut_value.tolist(), strict=True))
    faces = [set[int]() for _ in range(hierarchy.node_count)]
    for face, leaf in enumerate(hierarchy.face_leaf.tolist()):
        for node in _path(hierarchy, leaf):
            faces[node].add(face)
    return {
        (frozenset(faces[n]), float(hierarchy.area[n]), int(hierarchy.face_count[n]), cut_value.get(n, -1.0))
        for n in range(hierarchy.node_count)
    }
