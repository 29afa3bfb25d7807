"""CPU time of functions."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any


def cpu_s(function: Callable[[], Any], runs: int) -> float:
    """Return the least CPU seconds of some runs, after one that is not counted and loads what the function needs."""
    function()
    return min(_once(function) for _ in range(runs))


def _once(function: Callable[[], Any]) -> float:
    start = time.process_time()
    function()
    return time.process_time() - start
