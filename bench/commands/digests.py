"""Digests of labels and files, to show that a change keeps results equal to the byte.

With --output, record the labels at 2, 5, 7, 12, 30 and the automatic number of segments, and the bytes of the GLB and
.cleave files: of models of the Princeton benchmark and of the authored assets, spread evenly over both lists (--part
models), and of every preset, solver, affinity, order, thinning and graph on three of them (--part choices). The folder
given with --assets contains models.tsv and SET/NAME.ply.

With --compare, print which digests differ between two files. Keys that only one of them contains are counted, so that a
file of all digests can be compared with one of a part. The exit status is 2 if digests differ.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from bench.arguments import add_jobs, require_folder_of, require_jobs
from bench.digests.comparison import compare, load_digests, render, save_digests
from bench.digests.record import record
from bench.digests.selection import Subject, choices_of, models_of
from bench.errors import BenchmarkError
from bench.pool import map_in_processes
from segcore import warm_up


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, metavar="DIR", help="the folder of the Princeton benchmark")
    parser.add_argument("--assets", type=Path, metavar="DIR", help="the folder of the authored assets")
    parser.add_argument("--output", type=Path, metavar="FILE.json", help="write the digests to this file")
    parser.add_argument("--part", choices=("models", "choices", "all"), default="all", help="default: all")
    parser.add_argument("--limit", type=int, default=40, metavar="N", help="models of each data set (default 40)")
    parser.add_argument(
        "--models",
        type=int,
        nargs="+",
        default=[125, 213],
        metavar="N",
        help="models of the Princeton benchmark for the choices, beside the first asset (default 125 213)",
    )
    add_jobs(parser)
    parser.add_argument("--compare", type=Path, nargs=2, metavar=("A.json", "B.json"), help="compare two files")


def run(arguments: argparse.Namespace) -> None:
    if arguments.compare is not None:
        _compare(*arguments.compare)
    elif None in (arguments.data, arguments.assets, arguments.output):
        raise BenchmarkError("Give --data, --assets and --output, or --compare with two files.")
    else:
        _record(arguments)


def _record(arguments: argparse.Namespace) -> None:
    require_jobs(arguments.jobs)
    require_folder_of(arguments.output)
    subjects: list[Subject] = []
    if arguments.part != "choices":
        subjects += models_of(arguments.data, arguments.assets, arguments.limit)
    if arguments.part != "models":
        subjects += choices_of(arguments.data, arguments.assets, arguments.models)
    digests = map_in_processes(record, subjects, arguments.jobs, warm_up)
    save_digests(arguments.output, {subject.key: one for subject, one in zip(subjects, digests, strict=True)})
    print(f"Wrote {len(subjects)} digests to {arguments.output}")


def _compare(a: Path, b: Path) -> None:
    comparison = compare(load_digests(a), load_digests(b))
    print(render(comparison))
    if comparison.different:
        raise BenchmarkError(f"{len(comparison.different)} results differ: see the lines above.")
    if not comparison.equal:
        raise BenchmarkError("The two files have no key in common: record the same models for both.")
