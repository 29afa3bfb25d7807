"""Jobs per second with one, two and four workers, and the memory of the processes over thousands of jobs.

All jobs are queued before the workers start; the time is from the start of the first to the end of the last. Compare
the rows of one run only: the times depend on the machine. With --from, another version is measured after this one, and
the memory is not.
"""

from __future__ import annotations

import argparse

from bench.checkout import HERE, version
from bench.load.throughput import memory, throughput


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--workers", type=int, nargs="*", default=[1, 2, 4], metavar="N", help="worker processes")
    parser.add_argument("--jobs", type=int, default=200, metavar="N", help="jobs for each row (%(default)s)")
    parser.add_argument("--faces", type=int, default=20_000, metavar="N", help="faces of each mesh (%(default)s)")
    parser.add_argument(
        "--memory-jobs", type=int, default=2000, metavar="N", help="jobs for the memory, 0 for none (%(default)s)"
    )

    parser.add_argument(
        "--from", dest="previous", metavar="VERSION", help="a commit, or the folder of a checkout, to compare with"
    )


def run(arguments: argparse.Namespace) -> None:
    if arguments.previous:
        _compare(arguments.previous, arguments.workers, arguments.jobs, arguments.faces)
        return
    _print_throughput(arguments.workers, arguments.jobs, arguments.faces)
    if arguments.memory_jobs:
        print()
        _print_memory(arguments.memory_jobs)


def _print_throughput(workers: list[int], jobs: int, faces: int) -> None:
    print(f"| workers | {jobs} jobs of {faces} faces, s | jobs a second | to the first row |")
    print("|---|---|---|---|")
    first: float | None = None
    for count in workers:
        found = throughput(count, jobs, faces)
        first = first or found.seconds
        rate = found.jobs_per_s(jobs)
        print(f"| {count} | {found.seconds:.1f} | {rate:.2f} | {first / found.seconds:.2f} |", flush=True)


def _compare(previous: str, workers: list[int], jobs: int, faces: int) -> None:
    """Measure both versions in turn, for each number of workers."""
    print(f"| workers | jobs a second | {previous} | ratio |")
    print("|---|---|---|---|")
    with version(previous) as root:
        for count in workers:
            this, other = (throughput(count, jobs, faces, one).jobs_per_s(jobs) for one in (HERE, root))
            print(f"| {count} | {this:.2f} | {other:.2f} | {this / other:.2f} |", flush=True)


def _print_memory(jobs: int) -> None:
    print("| after jobs | service, MB | worker, MB | janitor, MB |")
    print("|---|---|---|---|")
    for count, megabytes in memory(jobs, samples=4, faces=500):
        row = " | ".join(f"{megabytes[name]:.1f}" for name in ("service", "worker", "janitor"))
        print(f"| {count} | {row} |", flush=True)
