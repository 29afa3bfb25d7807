from fractions import Fraction

import numpy as np
import pytest

from segcore.array_kernels import distinct_pairs, dot
from segcore.arrays import largest_options, transformed


@pytest.mark.parametrize("count", [*range(18), 20_001])
def test_the_inner_product_has_every_term_once(count: int) -> None:
    x, y = np.random.default_rng(count).standard_normal((2, count))
    exact = sum((Fraction(a) * Fraction(b) for a, b in zip(x.tolist(), y.tolist(), strict=True)), Fraction(0))
    assert abs(dot(x, y) - float(exact)) <= 1e-16 * count * np.abs(x * y).max(initial=0.0)


def test_the_image_of_a_point_is_the_product_of_matrix_and_point() -> None:
    matrix = np.array([[0.0, -1.0, 0.0], [2.0, 0.0, 0.0]])
    points = np.array([[1.0, 2.0, 3.0], [5.0, 0.0, 7.0]])
    assert transformed(points, matrix).tolist() == [[-2.0, 2.0], [0.0, 10.0]]
    assert transformed(points[None], matrix).tolist() == [[[-2.0, 2.0], [0.0, 10.0]]]


@pytest.mark.parametrize(("pairs", "indices"), [(0, 1), (1, 2), (50, 4), (2000, 900), (2000, 7), (20, 10_000)])
def test_distinct_pairs_are_sorted_and_every_pair_is_one_of_them(pairs: int, indices: int) -> None:
    drawn = np.random.default_rng(pairs).integers(0, indices, (pairs, 2)).astype(np.int32)
    distinct, which = distinct_pairs(drawn)
    expected = sorted({(int(min(pair)), int(max(pair))) for pair in drawn})
    assert distinct.tolist() == [list(pair) for pair in expected]
    np.testing.assert_array_equal(distinct[which], np.sort(drawn, axis=1))


def test_the_option_with_the_largest_sum_is_taken_the_last_of_equal_ones_and_the_default_of_none() -> None:
    item, option = np.array([0, 0, 0, 2, 2]), np.array([1, 4, 1, 3, 5])
    value = np.array([1.0, 1.5, 1.0, 2.0, 2.0])
    assert largest_options(np.array([7, 8, 9], dtype=np.int32), item, option, value).tolist() == [1, 8, 5]
