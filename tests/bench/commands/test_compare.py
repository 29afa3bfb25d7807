"""The compare command on two saved results."""

from pathlib import Path

import numpy as np
import pytest

from bench.__main__ import main
from bench.princeton.dataset import read_models
from bench.princeton.evaluation import evaluate_model
from bench.princeton.results import load_results, save_results
from helpers.bench.strips import STRIP_CATEGORIES, EvenSegmenter


def test_compare_prints_the_difference_of_two_files(
    strips: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    paths = [tmp_path / "a.json", tmp_path / "b.json"]
    for path, seed in zip(paths, (0, 1), strict=True):
        results = [evaluate_model(model, EvenSegmenter(), (seed,), "given") for model in read_models(strips)]
        save_results(path, results, "given", {})
    a, b = (load_results(path).scores for path in paths)
    assert main(["compare", *map(str, paths)]) == 0
    difference = np.mean([b[m].one_minus_rand - a[m].one_minus_rand for m in STRIP_CATEGORIES])
    line = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("one_minus_rand"))
    assert line.split()[4] == f"{difference:.4f}"
