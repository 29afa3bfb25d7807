"""A day of a small team: keys, a proxy, webhooks that fail, a host that is lost, and an upgrade with jobs waiting.

Three clients send jobs and batches through nginx, below a path, repeat requests, cancel and delete. Their receiver of
webhooks refuses messages, goes away and comes back; a host with a worker loses its power and comes back; the version
--from is replaced by the present one while jobs wait and run. In the evening every job is compared with what segcore
gives directly, and nobody may see anything of the others. Needs nginx. The exit status is 1 if anything is wrong.
"""

from __future__ import annotations

import argparse

from bench.day.finding import render
from bench.day.script import DayPlan, day


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--from",
        dest="previous",
        metavar="COMMIT",
        help="the version in the morning (default: the present one, which is stopped and started again)",
    )


def run(arguments: argparse.Namespace) -> int:
    findings = day(DayPlan(previous=arguments.previous))
    print(render(findings))
    return int(any(finding.is_wrong for finding in findings))
