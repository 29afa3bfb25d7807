from itertools import combinations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from segcore.cut.order import best_order, best_order_of_steps


@st.composite
def forests(draw):
    count = draw(st.integers(1, 8))
    parent = np.array([draw(st.integers(-1, s - 1)) for s in range(count)], np.int32)
    gain = np.array(draw(st.lists(st.integers(-5, 5), min_size=count, max_size=count)), float)
    return parent, gain


def allowed(parent, chosen):
    return all(parent[s] < 0 or parent[s] in chosen for s in chosen)


@settings(max_examples=200)
@given(forests())
def test_parents_come_first_and_every_split_once(forest):
    parent, gain = forest
    order, _ = best_order(parent, gain, np.ones(len(gain)))
    assert sorted(order) == list(range(len(gain)))
    assert all(parent[s] < 0 or order.index(parent[s]) < order.index(s) for s in order)


@settings(max_examples=200)
@given(forests())
def test_no_other_choice_of_splits_gains_more_than_the_worthwhile_ones(forest):
    parent, gain = forest
    order, worthwhile = best_order(parent, gain, np.ones(len(gain)))
    choices = [c for k in range(len(gain) + 1) for c in combinations(range(len(gain)), k) if allowed(parent, c)]
    best = max(sum(gain[list(chosen)]) for chosen in choices)
    assert sum(gain[order[:worthwhile]]) == best


def test_a_split_that_makes_a_good_one_possible_is_drawn_forward():
    # Split 0 alone loses 1 but lets 1 gain 9; split 2 gains 3 by itself.
    order, worthwhile = best_order(np.array([-1, 0, -1]), np.array([-1.0, 9.0, 3.0]), np.ones(3))
    assert order == [0, 1, 2]
    assert worthwhile == 3


def test_worth_is_weighed_against_cost():
    order, _ = best_order(np.array([-1, -1]), np.array([3.0, 2.0]), np.array([3.0, 1.0]))
    assert order == [1, 0]


@settings(max_examples=200)
@given(forests(), st.integers(0, 1000))
def test_splits_of_a_step_stay_together_and_are_worth_what_all_of_them_are(forest, seed):
    """Each split of a forest becomes a step of one or two splits, the second of which is below the first."""
    parent, gain = forest
    size = np.random.default_rng(seed).integers(1, 3, len(gain))
    step = np.repeat(np.arange(len(gain), dtype=np.int32), size)
    first = np.cumsum(size) - size
    parents = np.where(np.diff(step, prepend=-1) > 0, np.append(first, -1)[parent[step]], np.arange(len(step)) - 1)
    order, worthwhile = best_order_of_steps(step, parents.astype(np.int32), (gain / size)[step], (1.0 / size)[step])
    expected, least = best_order(parent, gain, np.ones(len(gain)))
    np.testing.assert_array_equal(step[order], np.repeat(expected, size[expected]))
    assert worthwhile == size[expected[:least]].sum()
    assert sorted(order) == list(range(len(step)))


def test_losing_splits_are_worthwhile_until_enough_is_spent_if_they_lose_little():
    parent, gain, cost = np.array([-1, -1, -1, -1]), np.array([0.01, -0.1, -0.02, -5.0]), np.array([0.1, 1.0, 1.0, 5.0])
    assert best_order(parent, gain, cost) == ([0, 2, 1, 3], 1)
    assert best_order(parent, gain, cost, least_cost=1.0, most_loss=0.2)[1] == 2
    assert best_order(parent, gain, cost, least_cost=2.0, most_loss=0.2)[1] == 3
    # Beyond that every split loses more than it may, so that nothing is gained by a part of it.
    assert best_order(parent, gain, cost, least_cost=3.0, most_loss=0.2)[1] == 1


def test_of_splits_that_lose_the_same_all_are_worthwhile_or_none():
    parent, gain, cost = np.array([-1, -1, -1, -1]), np.array([-0.1, -0.2, -0.1, -0.3]), np.array([1.0, 2.0, 1.0, 1.0])
    assert best_order(parent, gain, cost, least_cost=0.5, most_loss=0.2)[1] == 3
    assert best_order(parent, gain, cost, least_cost=0.5, most_loss=0.05)[1] == 0
