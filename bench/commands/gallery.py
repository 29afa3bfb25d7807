"""A contact sheet: models of the benchmark, or any files, in the colours of their segments, as one PNG.

With --cad, the meshes are forty solids as CAD programs write them. Without --models, --files and --cad, it shows
--limit models of the benchmark, spread evenly over the list. With --levels, each mesh is a row: the automatic number of
segments, then the levels, as far as the hierarchy of the mesh goes.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.cad import cad_meshes
from bench.datasets import read_mesh
from bench.princeton.dataset import Model, find_models, read_models

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from segcore.mesh import Mesh

_AZIMUTH = 35  # degrees; set by hand, for shapes that look three-dimensional


def add_arguments(parser: argparse.ArgumentParser) -> None:
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("--data", type=Path, metavar="DIR", help="the folder of the benchmark")
    source.add_argument("--files", type=Path, nargs="+", metavar="FILE", help="draw these meshes instead")
    source.add_argument("--cad", action="store_true", help="draw forty solids as CAD programs write them")
    parser.add_argument(
        "--levels", type=_numbers, default=[], metavar="N,N", help="further numbers of segments to draw"
    )
    parser.add_argument("--models", type=_numbers, metavar="N,N", help="numbers of the models to draw")
    parser.add_argument("--limit", type=int, default=40, metavar="N", help="number of models (default 40)")
    parser.add_argument(
        "--segments", choices=("given", "automatic"), default="automatic", help="number of segments (default automatic)"
    )
    parser.add_argument("--columns", type=int, default=8, metavar="N", help="models in a row (default 8)")
    parser.add_argument("--size", type=int, default=200, metavar="PIXELS", help="size of one picture (default 200)")
    parser.add_argument("--output", type=Path, required=True, metavar="FILE.png", help="write the sheet to this file")


def run(arguments: argparse.Namespace) -> None:
    from segcore.io.picture import write_png

    meshes = _meshes(arguments)
    tiles = [tile for mesh, segments in meshes for tile in _tiles(mesh, segments, arguments)]
    columns = 1 + len(arguments.levels) if arguments.levels else arguments.columns
    tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % columns)
    rows = [np.concatenate(tiles[i : i + columns], axis=1) for i in range(0, len(tiles), columns)]
    with arguments.output.open("wb") as target:
        write_png(target, np.concatenate(rows))
    print(f"{len(meshes)} meshes in {arguments.output}")


def _meshes(arguments: argparse.Namespace) -> list[tuple[Mesh, int | None]]:
    """Return the meshes, each with the number of segments to draw, None for the automatic one."""
    if arguments.cad:
        return [(mesh, None) for mesh in cad_meshes().values()]
    if arguments.files is not None:
        return [(read_mesh(path, path.name), None) for path in arguments.files]
    given = arguments.segments == "given"
    return [(model.read_mesh(), model.segments if given else None) for model in _chosen(arguments)]


def _chosen(arguments: argparse.Namespace) -> list[Model]:
    if arguments.models is None:
        return read_models(arguments.data, arguments.limit)
    return find_models(arguments.data, arguments.models)


def _tiles(mesh: Mesh, segments: int | None, arguments: argparse.Namespace) -> list[NDArray[np.uint8]]:
    """Return the picture of a mesh, and one for every level; an empty one if its hierarchy does not go so far."""
    from segcore import segment
    from segcore.io.picture import draw

    hierarchy = segment(mesh)
    first = None if segments is None else min(segments, hierarchy.max_segments)
    levels = [None if level > hierarchy.max_segments else hierarchy.labels(level) for level in arguments.levels]
    tiles = [hierarchy.labels(first), *levels]
    empty = np.zeros((arguments.size, arguments.size, 4), dtype=np.uint8)
    return [empty if labels is None else draw(mesh, labels, arguments.size, _AZIMUTH) for labels in tiles]


def _numbers(text: str) -> list[int]:
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"these are numbers with commas between them, not {text!r}") from None
