"""Congruent parts are cut off alike."""

import numpy as np
import pytest

from helpers.bodies.jointed_parts import BODY, FLAT, LEG, LONG_LEG, Parts, one_by_one, star
from helpers.bodies.limbs import body_with_limbs
from segcore.cut.bodies import pieces_of
from segcore.cut.equal_cuts import PartedBodies, equal_cuts, means_of_groups
from segcore.cut.fields import ClusterFields, Segment
from segcore.graphs.cheeger import cut_of
from segcore.method import segment


def groups(parts: Parts, cuts: list[tuple[set[int], set[int]]]) -> list[int]:
    """The groups of equal cuts, numbered by their first splits."""
    graph, points, _ = parts.graph()
    number = equal_cuts(graph, points, parts.tree(cuts)).tolist()
    first = list(dict.fromkeys(number))
    return [first.index(n) for n in number]


def test_cuts_that_cut_off_congruent_parts_are_equal() -> None:
    assert groups(star([LEG, LONG_LEG, LEG, FLAT, LEG]), one_by_one([1, 2, 3, 4, 5])) == [0, 1, 0, 2, 0]


def test_cuts_of_different_lengths_are_not_equal() -> None:
    assert groups(star([LEG, LEG], widths={1: 4}), one_by_one([1, 2])) == [0, 1]


def test_equal_parts_of_different_bodies_are_cut_off_by_equal_cuts() -> None:
    """Two legs that are parts of a head and of the body."""
    parts = Parts([BODY, (4, 5), LEG, LEG], [(0, 1), (0, 2), (1, 3)])
    assert groups(parts, [({0, 2}, {1, 3}), ({0}, {2}), ({1}, {3})]) == [0, 1, 1]


@pytest.mark.parametrize(("web", "numbers"), [((6, 8), [0, 0]), ((2, 4), [0, 1])])
def test_the_last_of_two_equal_parts_is_cut_off_what_is_left(web: tuple[int, int], numbers: list[int]) -> None:
    """Two flanges at a web, which is a little smaller; a speck that is cut off a part does not count."""
    parts = Parts([web, BODY, BODY], [(0, 1), (0, 2)])
    assert groups(parts, [({0, 2}, {1}), ({2}, {0})]) == numbers


def test_what_is_cut_off_is_rather_the_smaller_part() -> None:
    """Legs at a body as large as two bodies, of which the second split cuts off the last leg."""
    parts = Parts([BODY, LEG, LEG, BODY], [(0, 1), (0, 2), (0, 3)])
    assert groups(parts, [({0, 1, 2}, {3}), ({0, 2}, {1}), ({0}, {2})]) == [0, 1, 1]


def test_the_value_of_a_group_is_the_weighted_mean() -> None:
    means = means_of_groups(np.array([7, 3, 7]), np.array([0.2, 0.9, 0.6]), np.array([3.0, 1.0, 1.0]))
    np.testing.assert_allclose(means, [0.3, 0.9, 0.3])


def test_what_is_congruent_to_an_earlier_part_is_recognised() -> None:
    """After the first leg the other one is known, but neither a longer part nor a cut through a piece."""
    graph, points, part = star([LEG, LEG, LONG_LEG]).graph()
    fields = ClusterFields.of(graph, points, np.zeros(len(part)), body=part.astype(np.int32))
    inside = fields.inside(Segment(np.arange(len(part), dtype=np.int32), graph, 0, 0.0))
    assert pieces_of(graph, inside.body).max() == 3
    cuts = [cut_of(graph, part == leg) for leg in (1, 2, 3)]
    divided = part.copy() == 1
    divided[np.flatnonzero(divided)[:3]] = False
    parts = PartedBodies()
    found = parts.parts(inside, [*cuts, cut_of(graph, divided)], np.array([True, True, True, False]))
    assert parts.has(found).tolist() == [False] * 4
    parts.add(found[0])
    assert parts.has(found).tolist() == [True, True, False, False]


@pytest.mark.parametrize("seed", [0, 1, 2, 12, 20, 39])
def test_equal_limbs_in_different_poses_are_cut_alike(seed: int) -> None:
    mesh, link = body_with_limbs(seed)
    labels = segment(mesh).labels()
    limbs = []
    for limb in range(4):
        label = [np.unique(labels[link == 1 + 4 * limb + i]).tolist() for i in range(4)]
        limbs.append([label[i] == label[i + 1] for i in range(3)] + [len(own) for own in label])
    assert limbs == [limbs[0]] * 4
