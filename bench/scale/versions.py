"""Compares one segmentation by this version, in one thread and in two, with that by another version."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from bench.checkout import HERE
from bench.errors import BenchmarkError
from bench.text import format_table, number
from segcore.progress import STAGES

_PROBE = HERE / "bench" / "scale" / "probe.py"
# The threads share one heap, as those of a work-horse do (service/host/programs.py).
_ENVIRONMENT = {"MALLOC_ARENA_MAX": "1"}


@dataclass(frozen=True, slots=True)
class Run:
    """The cost of one segmentation."""

    faces: int
    cpu_s: float
    wall_s: float
    memory_bytes: dict[str, int]  # growth of the peak memory of the process, by stage
    line_s: dict[str, float]  # CPU seconds by line of segcore

    @property
    def peak_bytes(self) -> int:
        return max(self.memory_bytes.values())


def compare(base: Path, faces: int, runs: int) -> dict[str, Run]:
    """Return the runs of least CPU time of both versions, which take turns, each in its own process.

    Raises
    ------
    BenchmarkError
        If one of them fails.
    """
    kinds = {"before": (base, 1), "one thread": (HERE, 1), "two threads": (HERE, 2)}
    found: dict[str, list[Run]] = {name: [] for name in kinds}
    for _ in range(runs):
        for name, (root, threads) in kinds.items():
            found[name].append(_run(root, faces, threads))
    return {name: min(costs, key=lambda run: run.cpu_s) for name, costs in found.items()}


def _run(root: Path, faces: int, threads: int) -> Run:
    command = [sys.executable, str(_PROBE), str(faces), str(threads)]
    environment = os.environ | _ENVIRONMENT | {"PYTHONPATH": str(root)}
    done = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        reason = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise BenchmarkError(f"The version in {root} could not segment a dumbbell: {reason}")
    return Run(**json.loads(done.stdout.splitlines()[-1]))


def render(runs: dict[str, Run]) -> str:
    """Return a line for every version and number of threads, with ratios to the first one."""
    base = next(iter(runs.values()))
    header = ["version", "faces", "CPU s", "ratio", "wall s", "ratio", "MB", "bytes/face"]
    rows = [
        [
            name,
            str(run.faces),
            number(run.cpu_s, 2),
            number(run.cpu_s / base.cpu_s, 2),
            number(run.wall_s, 2),
            number(run.wall_s / base.wall_s, 2),
            number(run.peak_bytes / 1e6, 0),
            number(run.peak_bytes / run.faces, 0),
        ]
        for name, run in runs.items()
    ]
    return format_table(header, rows)


def render_memory(runs: dict[str, Run]) -> str:
    """Return a line for every version and number of threads, with the growth of the memory up to each stage."""
    rows = [[name, *(number(run.memory_bytes[stage] / 1e6, 0) for stage in STAGES)] for name, run in runs.items()]
    return format_table(["version", *(f"{stage} MB" for stage in STAGES)], rows)


def render_lines(run: Run, most: int) -> str:
    """Return the lines of segcore that take the most CPU time."""
    costly = sorted(run.line_s.items(), key=lambda entry: -entry[1])[:most]
    return format_table(["line", "CPU s"], [[name, number(seconds, 3)] for name, seconds in costly])
