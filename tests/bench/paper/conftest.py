"""Fixtures of the tests of the paper's evaluation."""

from pathlib import Path

import pytest

from bench.paper.evaluation import MethodResults, evaluate_methods
from bench.paper.label_cache import LabelCache
from bench.peers.method import Method
from bench.princeton.dataset import read_models
from helpers.bench.paper_models import SHAPES, Slices, write_benchmark


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_benchmark(tmp_path_factory.mktemp("benchmark"))


@pytest.fixture(scope="module")
def results(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, MethodResults]:
    """The results of slices, and of slices that fail on the larger model."""
    faces = sorted(len(shape.mesh.faces) for _, shape, _ in SHAPES.values())
    methods: list[Method] = [Slices(), Slices("timid", most_faces=faces[0])]
    return evaluate_methods(read_models(folder), methods, LabelCache(tmp_path_factory.mktemp("cache")), jobs=2)
