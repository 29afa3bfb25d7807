"""The evaluation of the paper, reproduced: variants of its method, Cleave and other methods, in its figures and tables.

Figures 4 and 8 (four metrics), Tables 1 and 2 (ranks by category, time) and Figures 5 and 9 (examples) of Chahhou,
Moumoun, El Far, Gadi, Segmentation of 3D meshes using p-spectral clustering, TPAMI 2014. All methods are given the
number of segments. The other methods are k-means, CGAL's segmentation by shape diameters (built by this command; it
needs g++ and CGAL's headers) and V-HACD (it needs the package vhacdx).
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from bench.arguments import add_jobs, require_jobs
from bench.errors import BenchmarkError
from bench.paper.charts import require_matplotlib
from bench.paper.evaluation import MethodResults, evaluate_methods
from bench.paper.items import ITEMS, Evaluation, bearing
from bench.paper.label_cache import LabelCache
from bench.peers import PEERS
from bench.peers.method import Method
from bench.princeton.dataset import read_models
from bench.princeton.results import save_results


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, required=True, metavar="DIR", help="the folder of the benchmark")
    parser.add_argument("--limit", type=int, metavar="N", help="only N models, spread evenly over the list")
    add_jobs(parser)
    parser.add_argument(
        "--output",
        type=Path,
        metavar="FOLDER",
        help="write the tables, charts and pictures to this folder, and the scores of every method for the compare "
        "command",
    )
    parser.add_argument(
        "--only",
        type=lambda text: _names(text, ITEMS),
        default=tuple(ITEMS),
        metavar="NAME,NAME",
        help=f"some of {', '.join(ITEMS)} (default all)",
    )
    parser.add_argument(
        "--peers",
        type=lambda text: _names(text, PEERS),
        default=tuple(PEERS),
        metavar="NAME,NAME",
        help=f"some of {', '.join(PEERS)} (default all; '' for none)",
    )
    parser.add_argument(
        "--cache",
        type=Path,
        metavar="FOLDER",
        help="keep segmentations and the built program in this folder: a second run computes only what is missing or "
        "has changed",
    )


def run(arguments: argparse.Namespace) -> None:
    require_jobs(arguments.jobs)
    for folder in (arguments.output, arguments.cache):
        _make(folder)
    with TemporaryDirectory() as temporary:
        _run(arguments, arguments.cache or Path(temporary))


def _run(arguments: argparse.Namespace, kept: Path) -> None:
    models = read_models(arguments.data, arguments.limit)
    if arguments.output is not None:
        require_matplotlib()
    if "figure5" in arguments.only:
        bearing(arguments.data)
    peers = [PEERS[name](kept) for name in arguments.peers]
    methods = _methods(arguments.only, peers)
    for method in methods:
        method.prepare()
    cache = LabelCache(kept)
    results = evaluate_methods(models, methods, cache, arguments.jobs) if methods else {}
    if arguments.output is not None:
        _save(arguments.output, results)
    evaluation = Evaluation(arguments.data, models, results, peers, cache, arguments.output)
    for name in arguments.only:
        _report(name, evaluation)


def _methods(items: Sequence[str], peers: Sequence[Method]) -> list[Method]:
    """Return the methods that the items need, each once."""
    wanted = [method for name in items for method in ITEMS[name].methods(peers)]
    return list({method.key: method for method in wanted}.values())


def _save(output: Path, results: dict[str, MethodResults]) -> None:
    for key, one in results.items():
        parameters: dict[str, object] = {"method": one.method.title, "settings": one.method.settings}
        save_results(output / f"{key}.json", one.models, "given", parameters)


def _report(name: str, evaluation: Evaluation) -> None:
    text = f"{ITEMS[name].title}. {len(evaluation.models)} models.\n\n{ITEMS[name].make(evaluation)}\n"
    print(text)
    if evaluation.output is not None:
        path = evaluation.output / f"{name}.txt"
        try:
            path.write_text(text, encoding="utf-8")
        except OSError as error:
            raise BenchmarkError(f"The table cannot be written to {path}: {error.strerror}.") from error


def _make(folder: Path | None) -> None:
    if folder is None:
        return
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise BenchmarkError(f"The folder {folder} cannot be made: {error.strerror}.") from error


def _names(text: str, known: Iterable[str]) -> tuple[str, ...]:
    names = tuple(name for name in text.split(",") if name)
    for name in names:
        if name not in known:
            raise argparse.ArgumentTypeError(f"{name!r} is not one of {', '.join(known)}")
    return tuple(dict.fromkeys(names))
