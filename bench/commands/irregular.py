"""The same shapes in other meshes: the agreement of the segmentations with those of the original meshes.

Every model is segmented in its own mesh and in every version of it, with the number of segments given. The figure is
the share of the area on which the two segmentations agree, after the best matching of segments. All versions keep the
shape: half of the model split twice, decimated, refined in patches, with slivers, with noise, remeshed. The row "other
seed" has the same mesh and another seed, and shows the agreement of two segmentations of equal quality.
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.arguments import add_jobs, require_jobs
from bench.irregular.agreement import agreement
from bench.irregular.versions import VERSIONS, Remeshed
from bench.pool import map_in_processes
from bench.princeton.dataset import Model, read_models
from bench.princeton.summary import standard_error_of_mean
from bench.segmenter import CleaveSegmenter
from bench.text import format_table, number

if TYPE_CHECKING:
    from segcore.arrays import IntArray

SAME = "other seed"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, required=True, metavar="DIR", help="the folder of the benchmark")
    parser.add_argument("--limit", type=int, metavar="N", help="only N models, spread evenly over the list")
    add_jobs(parser)
    parser.add_argument(
        "--only", nargs="+", choices=[SAME, *VERSIONS], default=[SAME, *VERSIONS], metavar="NAME", help="some versions"
    )


def run(arguments: argparse.Namespace) -> None:
    require_jobs(arguments.jobs)
    models = read_models(arguments.data, arguments.limit)
    segmenter = CleaveSegmenter()
    measure_all = partial(measure, segmenter=segmenter, names=arguments.only)
    measured = map_in_processes(measure_all, models, arguments.jobs, segmenter.warm_up)
    print(render(models, arguments.only, measured))


def measure(model: Model, segmenter: CleaveSegmenter, names: Sequence[str]) -> list[float]:
    """Return the agreement of every version of a model with the original."""
    mesh = model.read_mesh()
    same = Remeshed(mesh.vertices, mesh.faces, np.arange(len(mesh.faces), dtype=np.int32))
    labels = _labels(segmenter, same, model.segments, seed=0)
    agreements = []
    for name in names:
        other = same if name == SAME else VERSIONS[name](mesh, np.random.default_rng(model.number))
        other_labels = _labels(segmenter, other, model.segments, seed=int(name == SAME))
        agreements.append(agreement(mesh, labels, other, other_labels))
    return agreements


def render(models: Sequence[Model], names: Sequence[str], measured: Sequence[Sequence[float]]) -> str:
    """Return a line for every version, with the mean and the least agreement over the models."""
    rows = []
    for name, values in zip(names, zip(*measured, strict=True), strict=True):
        error = standard_error_of_mean(values)
        above = sum(value >= 0.95 for value in values) / len(values)
        rows.append([name, number(statistics.fmean(values)), number(error), number(min(values)), f"{above:.0%}"])
    table = format_table(["version", "agreement", "std. error", "least", "at least 0.95"], rows)
    return (
        f"{len(models)} models, number of segments given: share of the area that agrees with the original.\n\n{table}"
    )


def _labels(segmenter: CleaveSegmenter, shape: Remeshed, segments: int, seed: int) -> IntArray:
    from segcore.mesh import Mesh

    hierarchy = segmenter(Mesh(shape.vertices, shape.faces), seed)
    return hierarchy.labels(min(segments, hierarchy.max_segments))
