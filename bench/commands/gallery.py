"""A contact sheet: models of the benchmark in the colours of their segments, as one PNG.

Without --models, it shows --limit models, spread evenly over the list.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.princeton.dataset import Model, find_models, read_models

if TYPE_CHECKING:
    from numpy.typing import NDArray

_AZIMUTH = 35  # degrees; set by hand, for shapes that look three-dimensional


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, required=True, metavar="DIR", help="the folder of the benchmark")
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

    models = _chosen(arguments)
    tiles = [_tile(model, arguments.segments == "given", arguments.size) for model in models]
    tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % arguments.columns)
    rows = [np.concatenate(tiles[i : i + arguments.columns], axis=1) for i in range(0, len(tiles), arguments.columns)]
    with arguments.output.open("wb") as target:
        write_png(target, np.concatenate(rows))
    print(f"{len(models)} models in {arguments.output}: {', '.join(str(model.number) for model in models)}")


def _chosen(arguments: argparse.Namespace) -> list[Model]:
    if arguments.models is None:
        return read_models(arguments.data, arguments.limit)
    return find_models(arguments.data, arguments.models)


def _tile(model: Model, given: bool, size: int) -> NDArray[np.uint8]:
    from segcore import segment
    from segcore.io.picture import draw

    mesh = model.read_mesh()
    hierarchy = segment(mesh)
    labels = hierarchy.labels(min(model.segments, hierarchy.max_segments) if given else None)
    return draw(mesh, labels, size, _AZIMUTH)


def _numbers(text: str) -> list[int]:
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"models are numbers with commas between them, not {text!r}") from None
