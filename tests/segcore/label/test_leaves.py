import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.placements import FACES, GRAPH, Case, is_whole, neighbours, side_of
from segcore.label.leaves import (
    broken_leaves,
    changed_places,
    crossing_edges,
    edges_around,
    move,
    split_between,
)

cases = st.builds(Case.of, st.integers(2, 20), st.integers(0, 10**6))


@settings(max_examples=40)
@given(cases)
def test_the_split_between_two_places_is_the_one_with_them_on_different_sides(case):
    leaves = len(case.split_at)
    for one in range(leaves):
        for other in range(one + 1, leaves):
            assert split_between(one, other, case.split_at) == case.split_of(one, other)
            assert split_between(other, one, case.split_at) == case.split_of(one, other)


@settings(max_examples=40)
@given(cases)
def test_the_crossing_edges_are_those_between_different_places(case):
    crossing, split = crossing_edges(GRAPH.edges, case.place, case.split_at)
    ends = case.place[GRAPH.edges]
    np.testing.assert_array_equal(crossing, np.flatnonzero(ends[:, 0] != ends[:, 1]))
    assert split.tolist() == [case.split_of(one, other) for one, other in ends[crossing].tolist()]


@settings(max_examples=40)
@given(cases, st.integers(0, 10**6))
def test_faces_that_change_sides_get_the_place_of_a_neighbour_there(case, seed):
    rng = np.random.default_rng(seed)
    split = int(rng.integers(len(case.tree.split_node)))
    bounds = case.bounds(split)
    side = np.array([side_of(bounds, place) for place in case.place])
    free = np.flatnonzero((side >= 0) & (rng.random(len(side)) < 0.7)).astype(np.int32)
    lower = rng.random(len(free)) < 0.5
    local = np.full(len(side), -1, np.int32)
    faces, places = changed_places(free, lower, FACES, case.place, bounds, local)
    assert (local == -1).all()
    wanted = set(free[lower != (side[free] == 0)].tolist())
    assert set(faces.tolist()) == reached(wanted, side)
    assert len(set(faces.tolist())) == len(faces)
    after = case.place.copy()
    after[faces] = places
    for face, place in zip(faces.tolist(), places.tolist(), strict=True):
        assert side_of(bounds, place) == 1 - side[face]
        assert place in {after[g] for g, _ in neighbours(face)}


def reached(wanted, side):
    """The faces that change sides and are connected, through others of their side that do, to one that stays beyond."""
    found = {f for f in wanted if any(side[g] == 1 - side[f] and g not in wanted for g, _ in neighbours(f))}
    waiting = list(found)
    while waiting:
        f = waiting.pop()
        more = {g for g, _ in neighbours(f) if g in wanted and side[g] == side[f]} - found
        found |= more
        waiting += more
    return found


@settings(max_examples=40)
@given(cases, st.integers(0, 10**6))
def test_moving_faces_keeps_the_counts(case, seed):
    rng = np.random.default_rng(seed)
    faces = rng.choice(len(case.place), 30, replace=False).astype(np.int32)
    places = rng.integers(0, len(case.split_at), 30).astype(np.int32)
    placement = case.placement(case.place)
    move(faces, places, placement, FACES.rows)
    moved = case.place.copy()
    moved[faces] = places
    expected = case.placement(moved)
    np.testing.assert_array_equal(placement.place, expected.place)
    np.testing.assert_array_equal(placement.size, expected.size)
    np.testing.assert_array_equal(placement.crossings, expected.crossings)


@settings(max_examples=60)
@given(cases, st.integers(0, 10**6))
def test_a_leaf_is_broken_if_it_has_lost_too_many_faces_or_its_connection(case, seed):
    rng = np.random.default_rng(seed)
    faces = rng.choice(len(case.place), int(rng.integers(1, 60)), replace=False).astype(np.int32)
    before = case.place[faces]
    place = case.place.copy()
    place[faces] = rng.integers(0, len(case.split_at), len(faces))
    moved = place[faces] != before
    faces, before = faces[moved], before[moved]
    placement = case.placement(place)
    least = (np.bincount(case.place, minlength=len(case.split_at)) + 1) // 2
    visited = np.zeros(len(place), bool)
    broken = broken_leaves(faces, before, placement, least, FACES.rows, visited)
    assert not visited.any()
    for leaf in range(len(case.split_at)):
        if leaf in before and not gains(case.place, place, leaf):
            assert broken[leaf] == (placement.size[leaf] < least[leaf] or not is_whole(place, leaf))
        elif leaf not in before:
            assert not broken[leaf]


def gains(before, after, leaf):
    return bool(((after == leaf) & (before != leaf)).any())


@given(st.sets(st.integers(0, len(GRAPH.volume) - 1), max_size=30))
def test_the_edges_around_faces_are_listed_once_for_each_of_them(faces):
    around = edges_around(np.array(sorted(faces), np.int32), FACES.rows)
    expected = np.isin(GRAPH.edges, sorted(faces)).sum(axis=1)
    np.testing.assert_array_equal(np.bincount(around, minlength=len(GRAPH.edges)), expected)
