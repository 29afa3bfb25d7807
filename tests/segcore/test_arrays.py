from fractions import Fraction

import numpy as np
import pytest

from segcore.array_kernels import dot
from segcore.arrays import transformed


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
