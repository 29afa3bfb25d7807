"""Saved results."""

import json
import math
from pathlib import Path

import pytest

from bench.errors import BenchmarkError
from bench.princeton.dataset import read_models
from bench.princeton.evaluation import evaluate_model
from bench.princeton.results import load_results, save_results
from helpers.bench.strips import STRIP_CATEGORIES, EvenSegmenter


def test_loaded_results_have_the_undefined_scores_of_the_saved_ones(strips: Path, tmp_path: Path) -> None:
    results = [evaluate_model(model, EvenSegmenter(max_segments=1), (0,), "given") for model in read_models(strips)]
    save_results(tmp_path / "a.json", results, "given", {"seedless": 1})
    loaded = load_results(tmp_path / "a.json")
    assert "NaN" not in (tmp_path / "a.json").read_text()
    assert loaded.scores.keys() == set(STRIP_CATEGORIES)
    assert math.isnan(loaded.scores[1].cut_discrepancy)
    assert loaded.scores[3].gce == results[1].scores.gce


def test_files_of_another_format_are_rejected(tmp_path: Path) -> None:
    for content in ("[]", json.dumps({"format": "other"}), "{"):
        (tmp_path / "x.json").write_text(content)
        with pytest.raises(BenchmarkError, match="princeton --output"):
            load_results(tmp_path / "x.json")
