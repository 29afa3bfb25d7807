"""Cleave's own kernels beside those of libraries: sparse elimination, ray caster and parser of numbers.

Linear systems: the Laplacians of the coarse graphs and the smoothing of values on patches, against SuperLU with several
orderings, without the time to build the matrix. Rays: 48,000 from every mesh, and from the first one with its faces
subdivided, against Embree if its Python binding embreex is installed. Numbers: the coordinates of an OFF file, against
NumPy.

Times are CPU milliseconds, the least of some runs in one process with loaded kernels, means over the models; ratios are
those of the means to Cleave's. Set OMP_NUM_THREADS=1 and OPENBLAS_NUM_THREADS=1 to measure one thread.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from statistics import mean
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError
from bench.princeton.dataset import read_models
from bench.text import format_table, number

if TYPE_CHECKING:
    from bench.kernels.numbers import NumberTimes
    from bench.kernels.rays import RayTimes
    from bench.kernels.systems import SystemTimes


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, required=True, metavar="DIR", help="the folder of the Princeton benchmark")
    parser.add_argument(
        "--limit", type=int, default=10, metavar="N", help="only N models, spread evenly over the list (default 10)"
    )
    parser.add_argument(
        "--vertices", type=int, default=200_000, metavar="N", help="vertices of the OFF file (default 200,000)"
    )
    parser.add_argument(
        "--faces",
        type=int,
        default=500_000,
        metavar="N",
        help="least faces of the subdivided mesh (default 500,000)",
    )
    parser.add_argument("--runs", type=int, default=5, metavar="N", help="the fastest of N runs counts (default 5)")


def run(arguments: argparse.Namespace) -> None:
    if arguments.runs < 1 or arguments.vertices < 1:
        raise BenchmarkError("--runs and --vertices must be at least 1.")
    # Imported here so that listing commands does not load the compiled kernels.
    from bench.kernels import numbers, rays, systems

    meshes = [model.read_mesh() for model in read_models(arguments.data, arguments.limit)]
    coarse = [systems.measure(systems.coarse_laplacian(mesh), arguments.runs) for mesh in meshes]
    smoothing = [systems.measure(systems.smoothing_laplacian(mesh), arguments.runs) for mesh in meshes]
    print(render_systems(f"coarse graphs of {len(meshes)} models", coarse, systems.bridge_errors()))
    print(render_systems(f"smoothing on {len(meshes)} models", smoothing))
    print(render_rays(f"rays on {len(meshes)} models", [rays.measure(mesh, arguments.runs) for mesh in meshes]))
    fine = rays.subdivided(meshes[0], arguments.faces)
    print(render_rays(f"rays on {len(fine.faces)} faces", [rays.measure(fine, arguments.runs)]))
    for decimals in (6, 16):
        text = numbers.vertex_lines(arguments.vertices, decimals)
        title = f"{arguments.vertices} vertices, {decimals} decimals"
        print(render_numbers(title, numbers.measure(text, arguments.runs)))


def render_systems(
    title: str, measured: Sequence[dict[str, SystemTimes]], bridge_errors: dict[str, float] | None = None
) -> str:
    """Return a table with a row for every method; with the errors of a weak bridge if they are given."""
    own_factorise, own_solve = _means(measured, "Cleave")
    rows = []
    for name in measured[0]:
        factorise, solve = _means(measured, name)
        row = [
            name,
            number(mean(times[name].entries for times in measured), 0),
            number(1e3 * factorise, 2),
            number(factorise / own_factorise, 2),
            number(1e3 * solve, 3),
            number(solve / own_solve, 2),
        ]
        rows.append(row if bridge_errors is None else [*row, _error(bridge_errors[name])])
    header = [title, "entries", "factorise ms", "ratio", "solve ms", "ratio"]
    return format_table(header if bridge_errors is None else [*header, "error at a bridge of 1e-15"], rows) + "\n"


def _error(value: float) -> str:
    return f"{value:.0e}" if isfinite(value) else "singular"


def _means(measured: Sequence[dict[str, SystemTimes]], name: str) -> tuple[float, float]:
    return mean(times[name].factorise_s for times in measured), mean(times[name].solve_s for times in measured)


def render_rays(title: str, measured: Sequence[dict[str, RayTimes]]) -> str:
    """Return a table with a row for every method."""
    own = mean(times["Cleave"].build_s + times["Cleave"].cast_s for times in measured)
    rows = []
    for name in measured[0]:
        build, cast = mean(times[name].build_s for times in measured), mean(times[name].cast_s for times in measured)
        same = mean(times[name].same for times in measured)
        ratio = (build + cast) / own
        rows.append([name, number(1e3 * build, 1), number(1e3 * cast, 1), number(ratio, 2), number(same, 5)])
    return format_table([title, "build ms", "cast ms", "ratio", "same distance"], rows) + "\n"


def render_numbers(title: str, measured: dict[str, NumberTimes]) -> str:
    """Return a table with a row for every method."""
    own = measured["Cleave"].parse_s
    rows = [
        [name, number(1e3 * times.parse_s, 1), number(times.parse_s / own, 2), str(times.wrong)]
        for name, times in measured.items()
    ]
    return format_table([title, "ms", "ratio", "not the nearest float"], rows) + "\n"
