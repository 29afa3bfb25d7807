"""Kernels compiled with shortcuts through numba are right, also where others are compiled without them."""

import subprocess
import sys
from pathlib import Path

import numba
import pytest

from helpers.storage.kernels import environment_with

MODULE = """
import numpy as np
from segcore.jit.decorators import inner_kernel, kernel

@inner_kernel
def halves(values):
    if len(values) % 2:
        raise ValueError("an odd number of values")
    return values.reshape((2, -1))

@kernel
def lower_half(values):
    return halves(values)[0].copy()
"""
COMPILE = """
import numba
from segcore.kernels.shortcuts import take_shortcuts
print(take_shortcuts())
from made import lower_half
lower_half.compile((numba.float64[::1],))
"""
CALL = """
import numpy as np
from numba import njit
from made import halves, lower_half

assert lower_half(np.arange(4.0)).tolist() == [0.0, 1.0]
try:
    lower_half(np.arange(3.0))
except ValueError as error:
    assert str(error) == "an odd number of values", error

@njit
def upper_half(values):
    return halves(values)[1].copy()

assert upper_half(np.arange(4.0)).tolist() == [2.0, 3.0]
for function in (halves, lower_half):
    assert (sum(function.stats.cache_hits.values()), sum(function.stats.cache_misses.values())) == (1, 0)
"""


def run(script: str, folder: Path) -> str:
    environment = environment_with(folder / "cache")
    return subprocess.run(
        [sys.executable, "-c", script], cwd=folder, env=environment, check=True, stdout=subprocess.PIPE, text=True
    ).stdout


def test_kernels_of_a_process_with_shortcuts_are_loaded_called_and_compiled_into_others(tmp_path: Path) -> None:
    (tmp_path / "made.py").write_text(MODULE)
    takes_shortcuts = run(COMPILE, tmp_path) == "True\n"
    run(CALL, tmp_path)
    if not takes_shortcuts:
        pytest.skip(f"the shortcuts are not tested with numba {numba.__version__}: kernels are compiled without them")
