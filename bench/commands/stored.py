"""What requests and the janitor cost with 1,000 and with very many stored jobs, and with 10,000 waiting ones.

The stores are made by the layout of the store in a temporary folder, which is removed at the end: ended jobs of five
owners over a year, in batches and alone, succeeded, failed and canceled. A million jobs need about 14 GB and 4 million
files on the disk. Wall times are medians, CPU times means; memory is the growth of the peak of the process. Requests go
to `cleave serve` without workers, sweeps run in a process of their own.
"""

from __future__ import annotations

import argparse
import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from bench.errors import BenchmarkError
from bench.stored.cost import Cost
from bench.stored.filling import fill, fill_waiting
from bench.stored.requests import request_costs
from bench.stored.sweeps import janitor_costs, waiting_cost
from bench.text import format_table, number

_FEW, _WAITING = 1000, (1000, 10_000)
_ROUNDS = 3  # of retention, after three that are not measured
_EXPIRED = 400  # jobs, of which each of these rounds removes 50
_BYTES_OF_JOB, _FILES_OF_JOB = 14_000, 4  # as counted on ext4


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--jobs", type=int, default=1_000_000, metavar="N", help="stored jobs (default 1,000,000)")
    parser.add_argument("--data", type=Path, metavar="FOLDER", help="make the stores here (default: temporary folder)")


def run(arguments: argparse.Namespace) -> None:
    if arguments.jobs < _FEW:
        raise BenchmarkError(f"--jobs must be at least {_FEW}, not {arguments.jobs}.")
    folder = arguments.data or Path(tempfile.gettempdir())
    _require_room(folder, arguments.jobs)
    with tempfile.TemporaryDirectory(prefix="cleave-stored-", dir=folder) as made:
        few, many = (_costs(Path(made) / str(jobs), jobs) for jobs in (_FEW, arguments.jobs))
        print(render(few, many, f"{_FEW} jobs", f"{arguments.jobs} jobs"), end="\n\n")
        few, many = (_waiting(Path(made) / f"waiting-{jobs}", jobs) for jobs in _WAITING)
        print(render(few, many, *(f"{jobs} waiting" for jobs in _WAITING)), flush=True)


def render(few: Mapping[str, Cost], many: Mapping[str, Cost], few_name: str, many_name: str) -> str:
    """Return a line for each operation with both costs and their ratios."""
    header = ["operation"]
    for name in (few_name, many_name):
        header += [f"{name}: ms", "CPU ms", "MB"]
    rows = [
        [
            name,
            *(_cells(few[name])),
            *(_cells(many[name])),
            number(many[name].wall_s / few[name].wall_s, 2),
            number(many[name].cpu_s / few[name].cpu_s, 2) if few[name].cpu_s else "-",
        ]
        for name in few
    ]
    return format_table([*header, "ratio", "CPU ratio"], rows)


def _cells(cost: Cost) -> list[str]:
    return [number(1000 * cost.wall_s, 2), number(1000 * cost.cpu_s, 2), number(cost.memory_bytes / 1e6, 1)]


def _costs(data_dir: Path, jobs: int) -> dict[str, Cost]:
    filled = fill(data_dir, jobs, _EXPIRED)
    return dict([*request_costs(data_dir, filled), *janitor_costs(data_dir, _ROUNDS)])


def _waiting(data_dir: Path, jobs: int) -> dict[str, Cost]:
    fill_waiting(data_dir, jobs)
    return {"sweep of the janitor": waiting_cost(data_dir)}


def _require_room(folder: Path, jobs: int) -> None:
    if not folder.is_dir():
        raise BenchmarkError(f"{folder} is not a folder: create it first.")
    free_bytes, free_files = shutil.disk_usage(folder).free, os.statvfs(folder).f_favail
    if free_bytes < jobs * _BYTES_OF_JOB or 0 < free_files < jobs * _FILES_OF_JOB:
        need = f"{jobs * _BYTES_OF_JOB / 1e9:.0f} GB, {jobs * _FILES_OF_JOB} files"
        raise BenchmarkError(
            f"{folder} has no room for {jobs} jobs ({need}): free some, name another with --data, or lower --jobs."
        )
