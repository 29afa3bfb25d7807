"""Kernels that kernels alone call."""

import pytest

from segcore.jit.decorators import inner_kernel, kernel


@inner_kernel
def twice(value: float) -> float:
    return 2.0 * value


@kernel
def four_times(value: float) -> float:
    return twice(twice(value))


def test_kernels_call_an_inner_kernel_and_python_cannot() -> None:
    assert four_times(1.5) == 6.0
    with pytest.raises(TypeError, match="twice is called by kernels alone"):
        twice(1.5)
    assert twice.py_func(1.5) == 3.0


@kernel
def reciprocal(value: float) -> float:
    return 1.0 / value


def test_a_division_by_zero_gives_infinity() -> None:
    assert reciprocal(0.0) == float("inf")
