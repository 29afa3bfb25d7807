"""Paired differences."""

import math

import numpy as np
import pytest

from bench.princeton.comparison import paired_difference


def test_the_paired_difference_has_the_standard_error_of_the_differences() -> None:
    paired = paired_difference([0.1, 0.2, 0.3, math.nan], [0.2, 0.2, 0.6, 0.5])
    assert (paired.models, paired.better, paired.worse) == (3, 0, 2)
    assert paired.difference == pytest.approx(0.4 / 3)
    assert paired.standard_error == pytest.approx(np.std([0.1, 0, 0.3], ddof=1) / math.sqrt(3))
