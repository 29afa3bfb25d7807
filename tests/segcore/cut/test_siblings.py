"""Which splits are one step: those that separate equal parts of one body, and those of chains of equal parts."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.bodies.jointed_parts import BODY, FLAT, LEG, LONG_LEG, Parts, one_by_one, star
from helpers.meshes import refined
from segcore import shapes
from segcore.cut.siblings import sibling_steps
from segcore.method import segment


def steps(parts: Parts, cuts: list[tuple[set[int], set[int]]], step: list[int] | None = None) -> list[int]:
    """The steps of the tree whose split s separates two sets of parts, the larger one first."""
    graph, points, _ = parts.graph()
    tree = parts.tree(cuts)
    if step is not None:
        tree = replace(tree, step=np.array(step, np.int32))
    return sibling_steps(graph, points, tree).tolist()


def test_four_legs_are_one_step() -> None:
    assert steps(star([LEG] * 4), one_by_one([1, 2, 3, 4])) == [0, 0, 0, 0]


def test_the_last_leg_may_be_larger_than_the_body() -> None:
    small = Parts([(3, 3), LEG, LEG, LEG], [(0, 1), (0, 2), (0, 3)])
    assert steps(small, [({0, 2, 3}, {1}), ({0, 3}, {2}), ({3}, {0})]) == [0, 0, 0]


@pytest.mark.parametrize(
    ("legs", "options"),
    [
        ([LEG, LONG_LEG], {}),
        ([LEG, FLAT], {}),
        ([LEG, LEG], {"widths": {1: 4}}),
        ([LEG, LEG], {"affinity": 0.6}),
    ],
    ids=["another size", "another shape", "another length of the cut", "cuts that are not clear"],
)
def test_parts_that_differ_have_their_own_steps(legs: list[tuple[int, int]], options: dict[str, object]) -> None:
    assert steps(star(legs, **options), one_by_one([1, 2])) == [0, 1]


def test_a_chain_that_is_halved_recursively_is_one_step() -> None:
    chain = Parts([LEG] * 8, [(i, i + 1) for i in range(7)])
    halves = [({0, 1, 2, 3}, {4, 5, 6, 7})]
    quarters = [({i, i + 1}, {i + 2, i + 3}) for i in (0, 4)]
    links = [({i}, {i + 1}) for i in (0, 2, 4, 6)]
    assert steps(chain, halves + quarters + links) == [0] * 7


def test_a_chain_at_a_body_is_one_step_with_it() -> None:
    """A string of three beads that is cut off as a whole, and then into beads."""
    beads = Parts([BODY, LEG, LEG, LEG], [(0, 1), (1, 2), (2, 3)])
    assert steps(beads, [({0}, {1, 2, 3}), ({1, 2}, {3}), ({1}, {2})]) == [0, 0, 0]


def test_another_branch_may_be_split_in_between() -> None:
    """The legs are the splits 1 and 3; the head, part 3, is cut off first and split in between."""
    parts = Parts([BODY, LEG, LEG, (4, 5), (4, 3)], [(0, 1), (0, 2), (0, 3), (3, 4)])
    cuts = [({0, 1, 2}, {3, 4}), ({0, 2}, {1}), ({3}, {4}), ({0}, {2})]
    assert steps(parts, cuts) == [0, 1, 2, 1]


def test_a_part_that_is_cut_off_between_two_legs_joins_their_step() -> None:
    assert steps(star([LEG, FLAT, LEG]), one_by_one([1, 2, 3])) == [0, 0, 0]


def test_two_parts_between_two_legs_keep_them_apart() -> None:
    assert steps(star([LEG, FLAT, (4, 5), LEG]), one_by_one([1, 2, 3, 4])) == [0, 1, 2, 3]


def test_two_parts_between_pairs_of_legs_join_their_step() -> None:
    parts = star([LEG, LEG, FLAT, (4, 5), LEG, LEG, (4, 4)])
    assert steps(parts, one_by_one([1, 2, 3, 4, 5, 6, 7])) == [0, 0, 0, 0, 0, 0, 1]


def test_halves_of_legs_are_not_siblings_of_the_body() -> None:
    """Each leg is cut in two equal halves where it is wider than at the body."""
    parts = Parts([BODY, *[LEG] * 4], [(0, 1), (1, 2), (0, 3), (3, 4)], widths={1: 6, 3: 6})
    cuts = [({0, 3, 4}, {1, 2}), ({0}, {3, 4}), ({1}, {2}), ({3}, {4})]
    assert steps(parts, cuts) == [0, 0, 1, 2]


def test_steps_that_are_given_are_only_merged() -> None:
    """Splits 1 and 2 are one step already: the step of the legs takes it over, and split 2 with it."""
    parts = Parts([BODY, LEG, LEG, (4, 5), (4, 3)], [(0, 1), (0, 2), (0, 3), (3, 4)])
    cuts = [({0, 1, 2}, {3, 4}), ({0, 2}, {1}), ({3}, {4}), ({0}, {2})]
    assert steps(parts, cuts, [0, 1, 1, 2]) == [0, 1, 1, 1]
    assert steps(star([LEG, LONG_LEG]), one_by_one([1, 2]), [0, 0]) == [0, 0]


def test_equal_bodies_that_do_not_touch_are_one_step() -> None:
    apart = Parts([BODY, *[LEG] * 3], [])
    assert steps(apart, one_by_one([1, 2, 3])) == [0, 0, 0]


def test_a_tree_without_cuts_has_no_steps() -> None:
    assert steps(Parts([LEG], []), []) == []


def test_the_legs_of_a_table_are_children_of_one_node() -> None:
    """A top on four legs, all of them separate boxes."""
    top = shapes.box((2.0, 2.0, 0.2), (0.0, 0.0, 1.1))
    legs = [shapes.box((0.2, 0.2, 1.0), (x, y, 0.5)) for x in (-0.8, 0.8) for y in (-0.8, 0.8)]
    fine = [refined(mesh, 4) for mesh in (top, *legs)]
    hierarchy = segment(shapes.joined(*fine).mesh)
    areas = [hierarchy.area[node] for node in hierarchy.nary_children[0]]
    np.testing.assert_allclose(areas, [2 * 4 + 4 * 2 * 0.2, *[2 * 0.04 + 4 * 0.2] * 4], rtol=1e-6)
    assert hierarchy.step_ends[:2].tolist() == [1, 5]


def test_the_arms_of_a_burr_are_children_of_one_node() -> None:
    hierarchy = segment(shapes.burr(4, arms=6).mesh)
    assert len(hierarchy.nary_children[0]) == 7
    assert 7 in hierarchy.step_ends
