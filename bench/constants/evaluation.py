"""Segmentations and cuts with one constant changed."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import mean
from typing import TYPE_CHECKING

import numpy as np

from bench.constants.catalogue import Constant
from bench.princeton.dataset import Model
from bench.princeton.metrics import one_minus_rand, shared_faces
from bench.princeton.surface import Segmentation, Surface

if TYPE_CHECKING:
    from segcore.arrays import IntArray
    from segcore.graphs.surface_graph import SurfaceGraph


@dataclass(frozen=True, slots=True)
class Quality:
    """1-Rand of a model, mean over its people."""

    given: float  # with the number of segments that most people chose
    automatic: float


@dataclass(frozen=True, slots=True)
class CutQuality:
    """The cuts of a solver."""

    ratio: float  # mean over the graphs of the normalized Cheeger cut over the best known
    worst: float
    cpu_s: float  # mean


def quality(constant: Constant, value: float, model: Model) -> Quality:
    """Segment a model with another value of a constant."""
    from segcore.method import segment
    from segcore.parameters import SegmentationParameters

    mesh = model.read_mesh()
    with constant.set_to(value):
        hierarchy = segment(mesh, SegmentationParameters.from_mapping(dict(constant.parameters)))
    surface = Surface.from_mesh(mesh.vertices, mesh.faces)
    people = [Segmentation.of(surface, labels) for labels in model.read_people(len(mesh.faces))]

    def score(labels: IntArray) -> float:
        found = Segmentation.of(surface, labels)
        return mean(one_minus_rand(shared_faces(found, person)) for person in people)

    return Quality(score(hierarchy.labels(min(model.segments, hierarchy.max_segments))), score(hierarchy.labels()))


def cut_quality(
    constant: Constant, value: float, graphs: Sequence[SurfaceGraph], best_known: Sequence[float]
) -> CutQuality:
    """Cut graphs by the solver of a constant, with another value of it."""
    from segcore.parameters import SegmentationParameters
    from segcore.solvers.solvers import SOLVERS

    solve, parameters = SOLVERS[constant.solver], SegmentationParameters()
    with constant.set_to(value):
        start = time.process_time()
        cuts = [solve(graph, parameters, np.random.default_rng(0)).ncc for graph in graphs]
        cpu_s = (time.process_time() - start) / len(graphs)
    ratios = [cut / best for cut, best in zip(cuts, best_known, strict=True)]
    return CutQuality(mean(ratios), max(ratios), cpu_s)
