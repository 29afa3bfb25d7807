"""The metrics on the data of the benchmark, if the environment variables name its files."""

import csv
import os
from pathlib import Path

import pytest

from bench.datasets import read_labels
from bench.princeton.dataset import Model, read_models
from bench.princeton.evaluation import leave_one_out
from bench.princeton.metrics import evaluate, mean_scores
from bench.princeton.surface import Segmentation, Surface

TOLERANCE = 1e-9
PAIR = ("model", "candidate", "reference")  # the columns that are not metrics
# Names of columns of the benchmark's own program that differ from those in bench.princeton.metrics.
RENAMED = {"gce": "GCE", "lce": "LCE", "gce_by_face": "GCE_by_face", "lce_by_face": "LCE_by_face"}


def path_from_environment(name: str, what: str) -> Path:
    value = os.environ.get(name)
    if not value:
        pytest.skip(f"{name} is not set: it names {what}")
    return Path(value)


@pytest.fixture(scope="module")
def models() -> dict[int, Model]:
    folder = path_from_environment("CLEAVE_PSB_DIR", "the folder of the Princeton Segmentation Benchmark")
    return {model.number: model for model in read_models(folder)}


def test_metrics_agree_with_the_program_of_the_benchmark(models: dict[int, Model]) -> None:
    vectors = path_from_environment("CLEAVE_PSB_VECTORS", "the table of values of the benchmark's own program")
    with vectors.open(newline="", encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines, delimiter="\t"))
    assert rows
    for row in rows:
        expected = {name: float(value) for name, value in row.items() if name not in PAIR}
        assert computed(models[int(row["model"])], row) == pytest.approx(expected, rel=0, abs=TOLERANCE), row


def computed(model: Model, row: dict[str, str]) -> dict[str, float]:
    mesh = model.read_mesh()
    surface = Surface.from_mesh(mesh.vertices, mesh.faces)
    candidate, reference = (
        Segmentation.of(surface, read_labels(model.people_folder / row[role], len(mesh.faces)))
        for role in ("candidate", "reference")
    )
    scores = evaluate(surface, candidate, reference)
    return {RENAMED.get(name, name): getattr(scores, name) for name in scores.__slots__}


def test_people_differ_from_each_other_as_published_for_the_odd_half(models: dict[int, Model]) -> None:
    odd = [model for number, model in models.items() if number % 2 == 1]
    if len(odd) != 190:
        pytest.skip(f"the folder has {len(odd)} of the 190 odd models")
    means = []
    for model in odd:
        mesh = model.read_mesh()
        surface = Surface.from_mesh(mesh.vertices, mesh.faces)
        people = [Segmentation.of(surface, labels) for labels in model.read_people(len(mesh.faces))]
        means.append(leave_one_out(surface, people))
    overall = mean_scores(means)
    assert overall.one_minus_rand == pytest.approx(0.1085, abs=5e-5)
    assert overall.hamming == pytest.approx(0.1022, abs=5e-5)
    assert overall.cut_discrepancy == pytest.approx(0.1838, abs=5e-5)
