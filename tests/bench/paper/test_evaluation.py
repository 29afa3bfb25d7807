"""The evaluation of methods on two small models."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.paper.evaluation import MethodResults
from bench.princeton.dataset import read_models
from bench.princeton.evaluation import evaluate_model
from bench.princeton.results import load_results, save_results
from helpers.bench.paper_models import SHAPES, Slices
from segcore.mesh import Mesh


@dataclass(frozen=True)
class SlicesAtOnce:
    """The same slices as a segmenter of the princeton command."""

    max_segments: int = 100

    def warm_up(self) -> None:
        pass

    def __call__(self, mesh: Mesh, seed: int) -> "SlicesAtOnce":
        assert seed == 0
        return SlicesOf(mesh=mesh)


@dataclass(frozen=True)
class SlicesOf(SlicesAtOnce):
    mesh: Mesh | None = None

    def labels(self, segments: int | None = None) -> np.ndarray:
        assert self.mesh is not None
        return Slices().labels(self.mesh, segments)


def test_a_method_has_the_scores_of_the_princeton_command(folder: Path, results: dict[str, MethodResults]) -> None:
    for model, result in zip(read_models(folder), results["slices"].models, strict=True):
        expected = evaluate_model(model, SlicesAtOnce(), (0,), "given")
        assert (result.scores, result.people_scores) == (expected.scores, expected.people_scores)
        assert result.runs[0].segments == model.segments


def test_a_failure_has_no_time(results: dict[str, MethodResults]) -> None:
    assert (results["slices"].cpu_s, results["timid"].cpu_s) == ([0.5, 0.5], [0.5])


def test_results_can_be_compared_by_the_compare_command(results: dict[str, MethodResults], tmp_path: Path) -> None:
    for key, one in results.items():
        save_results(tmp_path / f"{key}.json", one.models, "given", {"settings": one.method.settings})
        assert load_results(tmp_path / f"{key}.json").scores.keys() == set(SHAPES)
