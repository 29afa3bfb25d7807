"""Kill the processes of a service at random, and compare the results with those of a run without kills.

Every job must exist afterwards, have succeeded, and have the same bytes as without the kills. The seed determines the
order and the kinds of the kills, but not their times relative to the jobs.
"""

from __future__ import annotations

import argparse

from bench.errors import BenchmarkError
from bench.soak.campaign import SoakPlan, SoakReport, soak
from bench.soak.faults import describe


def add_arguments(parser: argparse.ArgumentParser) -> None:
    plan = SoakPlan()
    parser.add_argument("--jobs", type=int, default=plan.jobs, metavar="N", help="jobs (%(default)s)")
    parser.add_argument(
        "--kills",
        type=int,
        default=plan.kills,
        metavar="N",
        help="kills of all processes except the queue server (%(default)s)",
    )
    parser.add_argument(
        "--queue-kills", type=int, default=plan.queue_kills, metavar="N", help="kills of the queue server (%(default)s)"
    )
    parser.add_argument(
        "--interval", type=float, default=plan.interval_s, metavar="S", help="mean seconds between kills (%(default)s)"
    )
    parser.add_argument("--workers", type=int, default=plan.workers, metavar="N", help="workers (%(default)s)")
    parser.add_argument(
        "--seed", type=int, default=plan.seed, metavar="N", help="seed of the order of kills (%(default)s)"
    )


def run(arguments: argparse.Namespace) -> None:
    report = soak(
        SoakPlan(
            jobs=arguments.jobs,
            kills=arguments.kills,
            queue_kills=arguments.queue_kills,
            interval_s=arguments.interval,
            workers=arguments.workers,
            seed=arguments.seed,
        )
    )
    print(render(report))
    if not report.is_clean:
        raise BenchmarkError("Jobs were lost, failed or have other results: see the table.")


def render(report: SoakReport) -> str:
    """Return the report as a Markdown table."""
    rows = {
        "jobs": report.jobs,
        f"kills ({describe(report.kills)})": report.kills.total(),
        "lost": report.lost,
        "failed": report.failed,
        "made twice": report.duplicates,
        "results whose bytes differ from a run without kills": report.differing,
        "jobs that were run again": report.run_again,
        "runs that ended after another had ended the job": report.dropped,
        "longest time from the death of a worker until its job ran again, s": f"{report.resumed_s:.1f}",
        "seconds from the last kill until all had ended": f"{report.settled_s:.1f}",
    }
    return "\n".join(["| | |", "|---|---|", *(f"| {name} | {value} |" for name, value in rows.items())])
