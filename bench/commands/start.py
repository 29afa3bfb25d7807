"""How long commands and the service take to start, in seconds and as ratios to another version.

The mesh has 20,480 faces. The commands of both versions run in turn. With compiled kernels the figures are medians of
several rounds; without, there is one round, for which every command gets an empty cache. CPU times include those of the
processes that a command starts; the ratio of CPU times hardly depends on what else the machine does.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

from bench.checkout import HERE, checked_out
from bench.errors import BenchmarkError
from bench.start.measurements import COLD, WARM, Seconds, Version, starts
from bench.text import format_table, number

Figures = dict[tuple[str, str], list[Seconds]]  # by the name of the start and the state of the kernels


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--from", dest="base", metavar="REV", help="the version to compare with")
    parser.add_argument("--rounds", type=int, default=5, metavar="N", help="with compiled kernels (default 5)")
    parser.add_argument("--warm", action="store_true", help="with compiled kernels only")


def run(arguments: argparse.Namespace) -> None:
    if arguments.rounds < 1:
        raise BenchmarkError(f"--rounds must be at least 1, not {arguments.rounds}.")
    with ExitStack() as stack:
        made = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="cleave-start-")))
        folders = {"now": HERE}
        if arguments.base is not None:
            folders[arguments.base] = stack.enter_context(checked_out(arguments.base))
        mesh = _write_mesh(made / "burr.off")
        versions = {name: Version(folder, made / f"kernels-{i}") for i, (name, folder) in enumerate(folders.items())}
        for version in versions.values():
            version.cache.mkdir()  # the service would choose another one if it did not exist
        print(render(_measured(versions, mesh, arguments.rounds, is_cold=not arguments.warm)))


def render(figures: Mapping[str, Figures]) -> str:
    """Return a line for each start: the medians of each version, and the ratios of the first one to the second."""
    names = list(figures)
    header = ["start", "kernels"] + [f"{name}: {kind}" for name in names for kind in ("s", "CPU s")]
    rows = []
    for key in figures[names[0]]:
        wall, cpu = ([_median(figures[name][key], kind) for name in names] for kind in ("wall", "cpu"))
        cells = [number(value, 2) for pair in zip(wall, cpu, strict=True) for value in pair]
        ratios = [number(values[0] / values[1], 2) for values in (wall, cpu) if len(names) > 1]
        rows.append([*key, *cells, *ratios])
    return format_table([*header, *(["ratio", "CPU ratio"] if len(names) > 1 else [])], rows)


def _measured(versions: Mapping[str, Version], mesh: Path, rounds: int, *, is_cold: bool) -> dict[str, Figures]:
    figures: dict[str, Figures] = {name: {} for name in versions}

    def measure(kernels: str) -> None:
        for name, version in versions.items():
            for start, seconds in starts(version, mesh, kernels):
                figures[name].setdefault((start, kernels), []).append(seconds)

    if is_cold:
        for version in versions.values():
            version.run("--help")  # compiles the bytecode of the first modules
            version.run("segment", "--help")
        measure(COLD)
    for version in versions.values():
        version.run("segment", str(mesh))
        version.serve(mesh)
    for _ in range(rounds):
        measure(WARM)
    return figures


def _median(seconds: Sequence[Seconds], kind: str) -> float:
    values: list[float] = [getattr(one, kind) for one in seconds]
    return statistics.median(values)


def _write_mesh(path: Path) -> Path:
    from segcore.io import write_mesh
    from segcore.shapes import burr

    write_mesh(path, burr().mesh)
    return path
