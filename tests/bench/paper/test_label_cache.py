"""The cache of segmentations."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from bench.errors import BenchmarkError
from bench.paper.label_cache import LabelCache
from bench.peers.method import Outcome
from helpers.bench.paper_models import Slices
from segcore.mesh import Mesh
from segcore.shapes import box


@dataclass(frozen=True)
class CountedSlices(Slices):
    """Slices that log every call."""

    log: Path = Path()

    def __call__(self, mesh: Mesh, segments: int) -> Outcome:
        with self.log.open("a") as file:
            file.write("called\n")
        return super().__call__(mesh, segments)

    @property
    def calls(self) -> int:
        return len(self.log.read_text().splitlines()) if self.log.exists() else 0


def test_a_segmentation_is_computed_once_for_each_state_of_method_mesh_and_number(tmp_path: Path) -> None:
    cache, mesh = LabelCache(tmp_path / "cache"), box()
    method = CountedSlices(log=tmp_path / "log")
    first = cache.outcome(method, 1, mesh, 3)
    again = cache.outcome(method, 1, mesh, 3)
    assert method.calls == 1
    assert np.array_equal(first.labels, again.labels)
    assert (again.cpu_s, again.failure) == (first.cpu_s, first.failure)
    for changed, other_mesh, segments in (
        (replace(method, settings="2"), mesh, 3),
        (method, box((2, 1, 1)), 3),
        (method, mesh, 4),
    ):
        before = method.calls
        cache.outcome(changed, 1, other_mesh, segments)
        assert method.calls == before + 1


def test_a_failure_is_cached_too(tmp_path: Path) -> None:
    cache = LabelCache(tmp_path / "cache")
    method = CountedSlices(most_faces=1, log=tmp_path / "log")
    first, again = (cache.outcome(method, 1, box(), 3) for _ in range(2))
    assert first.failure == again.failure == "too many faces."
    assert not again.labels.any()
    assert method.calls == 1


def test_a_damaged_file_is_replaced(tmp_path: Path) -> None:
    cache = LabelCache(tmp_path / "cache")
    method = CountedSlices(log=tmp_path / "log")
    first = cache.outcome(method, 1, box(), 3)
    (path,) = (tmp_path / "cache").rglob("*.npz")
    whole = path.read_bytes()
    for damaged in (b"", whole[: len(whole) // 2], b"not a segmentation"):
        path.write_bytes(damaged)
        assert np.array_equal(cache.outcome(method, 1, box(), 3).labels, first.labels)
    assert method.calls == 4


def test_a_cache_that_cannot_be_written_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("a file")
    with pytest.raises(BenchmarkError, match="cannot be kept"):
        LabelCache(tmp_path / "cache").outcome(Slices(), 1, box(), 2)
