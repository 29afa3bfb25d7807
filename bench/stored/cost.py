"""Measures what an operation costs a process: wall time, CPU time and memory."""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from bench.memory import peak_memory, reset_peak

_WARM_RUNS = 3  # not measured: caches of the process are filled and modules are imported


@dataclass(frozen=True, slots=True)
class Cost:
    """The cost of one operation."""

    wall_s: float  # median
    cpu_s: float  # mean
    memory_bytes: int  # growth of the peak memory over all runs


def cost_of(operation: Callable[[int], object], runs: int, process: int | None = None) -> Cost:
    """Return the cost of an operation, which gets the number of the run, to a process, by default to this one."""
    pid = process or os.getpid()
    for run in range(_WARM_RUNS):
        operation(run)
    before_bytes, before_s = reset_peak(pid), _cpu_s(pid)
    times_s = []
    for run in range(_WARM_RUNS, _WARM_RUNS + runs):
        began_at = time.perf_counter()
        operation(run)
        times_s.append(time.perf_counter() - began_at)
    cpu_s = (_cpu_s(pid) - before_s) / runs
    return Cost(statistics.median(times_s), cpu_s, peak_memory(pid) - before_bytes)


def _cpu_s(pid: int) -> float:
    """Return the CPU time of a process, of which Linux counts hundredths of a second."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
