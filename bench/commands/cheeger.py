"""The solvers against each other: the normalized Cheeger cut that each of them finds, and its time.

The folder given with --references contains reference.tsv and NAME.npz for every graph in it: the results of other
programs. With --data, the folder of the Princeton benchmark, the first cut of every model is measured too, on the
coarse and on the fine graph of its largest component. Cuts are ratios to the best value that is known or that any of
the solvers found.

Times are CPU milliseconds, the median over the runs, in one process with loaded kernels. Set OMP_NUM_THREADS=1 to
measure one thread, and run nothing else on the machine. They are compared with the seconds of the reference code with
six starts.
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
    parser.add_argument("--solvers", nargs="+", choices=SOLVERS, default=SOLVERS, help="default: all")


def run(arguments: argparse.Namespace) -> None:
    if arguments.runs < 1:
        raise BenchmarkError(f"--runs must be at least 1, not {arguments.runs}.")
    # Imported here so that listing commands does not load the compiled kernels.
    from bench.cheeger import measurements, references, report

    graphs = references.read_references(arguments.references)
    models = [] if arguments.data is None else read_models(arguments.data, arguments.limit)
    measurements.warm_up(arguments.solvers)
    measured = [measurements.measure(one.graph, arguments.solvers, arguments.runs) for one in graphs]
    print(report.render_references(graphs, measured))
    if models:
        cuts: dict[str, list[measurements.Row]] = {"coarse": [], "fine": []}
        for model in models:
            for kind, graph in measurements.first_cut_graphs(model).items():
                cuts[kind].append(measurements.measure(graph, arguments.solvers, 1))
        print()
        print(report.render_first_cuts(cuts, [str(model.number) for model in models]))
