"""Kernels compiled with shortcuts through numba are right, and are compiled that way with the numba of today."""

import subprocess
import sys
from pathlib import Path

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
assert take_shortcuts()
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


def test_kernels_of_a_process_with_shortcuts_are_loaded_called_and_compiled_into_others(tmp_path: Path) -> None:
    (tmp_path / "made.py").write_text(MODULE)
    for script in (COMPILE, CALL):
        subprocess.run(
            [sys.executable, "-c", script], cwd=tmp_path, env=environment_with(tmp_path / "cache"), check=True
        )
