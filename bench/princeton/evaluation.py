"""Evaluates one model: its segmentations against every person's, and its people against each other."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from itertools import permutations
from typing import TYPE_CHECKING, Literal, Protocol

from bench.errors import BenchmarkError
from bench.princeton.dataset import Model
from bench.princeton.metrics import Scores, evaluate, mean_scores
from bench.princeton.surface import Segmentation, Surface

if TYPE_CHECKING:
    from segcore.arrays import IntArray
    from segcore.mesh import Mesh

SegmentChoice = Literal["given", "automatic"]


class Levels(Protocol):
    """Segmentations of one mesh into every number of segments up to a largest one, as ``segcore.Hierarchy``."""

    @property
    def max_segments(self) -> int: ...

    def labels(self, segments: int | None = None) -> IntArray: ...


class Segmenter(Protocol):
    """A segmentation method. It is sent to other processes, so it must be picklable."""

    def warm_up(self) -> None:
        """Compile or load everything that the first mesh needs; called once in every process."""

    def __call__(self, mesh: Mesh, seed: int) -> Levels:
        """Segment a mesh; raises BenchmarkError if that is not possible."""


@dataclass(frozen=True, slots=True)
class Run:
    """One segmentation of a model with one seed."""

    seed: int
    segments: int  # number of segments
    fell_short: bool  # fewer segments than requested, because the hierarchy ends earlier
    cpu_s: float  # CPU time of the segmentation alone, all threads of the process
    undefined_cut_discrepancies: int  # number of people against whom it is undefined
    scores: Scores  # mean over the people


@dataclass(frozen=True, slots=True)
class ModelResult:
    """The measurements on one model."""

    model: int
    category: str
    faces: int
    people: int
    given_segments: int
    runs: tuple[Run, ...]  # one for every seed
    people_scores: Scores  # mean over the ordered pairs of different people

    @property
    def scores(self) -> Scores:
        """Mean over the seeds."""
        return mean_scores([run.scores for run in self.runs])


def evaluate_model(model: Model, segmenter: Segmenter, seeds: tuple[int, ...], choice: SegmentChoice) -> ModelResult:
    """Segment a model once per seed and compare it with all of its people.

    Parameters
    ----------
    choice : ``given`` for the number of segments that the model lists, ``automatic`` for the segmenter's own.

    Raises
    ------
    BenchmarkError
        If a file of the model cannot be used, or the segmenter fails on it.
    """
    mesh = model.read_mesh()
    labels_of_people = model.read_people(len(mesh.faces))
    try:
        surface = Surface.from_mesh(mesh.vertices, mesh.faces)
        people = [Segmentation.of(surface, labels) for labels in labels_of_people]
        requested = model.segments if choice == "given" else None
        runs = [_run(mesh, surface, people, segmenter, seed, requested) for seed in seeds]
        people_scores = leave_one_out(surface, people)
    except (BenchmarkError, ValueError) as error:
        raise BenchmarkError(f"Model {model.number}: {error}") from error
    return ModelResult(
        model=model.number,
        category=model.category,
        faces=len(mesh.faces),
        people=len(people),
        given_segments=model.segments,
        runs=tuple(runs),
        people_scores=people_scores,
    )


def leave_one_out(surface: Surface, people: list[Segmentation]) -> Scores:
    """Return the mean over all ordered pairs of different people: each of them is compared with all others."""
    return mean_scores([evaluate(surface, one, other) for one, other in permutations(people, 2)])


def _run(
    mesh: Mesh, surface: Surface, people: list[Segmentation], segmenter: Segmenter, seed: int, requested: int | None
) -> Run:
    start = time.process_time()
    levels = segmenter(mesh, seed)
    cpu_s = time.process_time() - start
    possible = None if requested is None else min(requested, levels.max_segments)
    segmentation = Segmentation.of(surface, levels.labels(possible))
    scores = [evaluate(surface, segmentation, person) for person in people]
    return Run(
        seed=seed,
        segments=segmentation.segments,
        fell_short=requested is not None and segmentation.segments < requested,
        cpu_s=cpu_s,
        undefined_cut_discrepancies=sum(math.isnan(score.cut_discrepancy) for score in scores),
        scores=mean_scores(scores),
    )
