"""The solvers against each other: the normalized Cheeger cut that each finds, and its time.

The folder given with --references has reference.tsv and NAME.npz for every graph in it: what other code reaches there.
With --data, the folder of the Princeton benchmark, the first cut of every model is measured too, on the coarse and on
the fine graph of its largest component. Cuts are ratios to the best value that is known or that any solver here found.

Times are processor milliseconds, the median over the runs, in one warm process: set OMP_NUM_THREADS=1 to have those of
one thread, and leave the machine alone. They are set against the seconds of the reference code with six starts.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from bench.errors import BenchmarkError
from bench.princeton.dataset import read_models

SOLVERS = ("flow", "fiedler", "inverse_power", "split_bregman", "p_laplacian")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--references", type=Path, required=True, metavar="DIR", help="the folder of the reference graphs"
    )
    parser.add_argument("--data", type=Path, metavar="DIR", help="the folder of the Princeton benchmark")
    parser.add_argument("--limit", type=int, metavar="N", help="only N models, spread evenly over the list")
    parser.add_argument("--runs", type=int, default=5, metavar="N", help="runs with seeds 0 to N - 1 (default 5)")
    parser.add_argument("--solvers", nargs="+", choices=SOLVERS, default=SOLVERS, help="by default all")


def run(arguments: argparse.Namespace) -> None:
    if arguments.runs < 1:
        raise BenchmarkError(f"--runs must be at least 1, not {arguments.runs}.")
    # Imported here so that listing commands does not load the compiled kernels.
    from bench import cheeger

    references = cheeger.read_references(arguments.references)
    models = [] if arguments.data is None else read_models(arguments.data, arguments.limit)
    cheeger.warm_up(arguments.solvers)
    measured = [cheeger.measure(reference.graph, arguments.solvers, arguments.runs) for reference in references]
    print(cheeger.render_references(references, measured))
    if models:
        print()
        print(cheeger.render_first_cuts(models, arguments.solvers))
