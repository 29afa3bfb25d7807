"""The digests of one segmentation."""

import hashlib
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

from bench.digests.record import record
from bench.digests.selection import Subject, models_of
from bench.errors import BenchmarkError
from segcore import read_mesh, segment
from segcore.io.writing import WRITERS


def bell(strips: Path, assets: Path) -> Subject:
    return models_of(strips, assets, 2)[-1]


def digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:24]


def test_the_digests_are_those_of_the_labels_and_the_files(strips: Path, assets: Path) -> None:
    subject = bell(strips, assets)
    found = record(subject)
    mesh = read_mesh(subject.path)
    hierarchy = segment(mesh)
    assert found["segments"] == [hierarchy.automatic_segments, hierarchy.max_segments]
    for name, level in (("2", 2), ("30", min(30, hierarchy.max_segments)), ("auto", None)):
        assert found[name] == digest(hierarchy.labels(level).astype(np.int32).tobytes())
    for name in ("glb", "cleave"):
        file = BytesIO()
        WRITERS[name].write(file, mesh, hierarchy, None)
        assert found[name] == digest(file.getvalue())


def test_a_level_above_the_finest_is_the_finest(strips: Path, assets: Path) -> None:
    subject = bell(strips, assets)
    found = record(Subject(subject.name, subject.path, {"max_segments": 5}))
    assert found["5"] == found["7"] == found["30"] != found["2"]
    assert found["segments"][1] == 5


def test_an_error_names_the_model_and_its_parameters(strips: Path, assets: Path) -> None:
    subject = bell(strips, assets)
    with pytest.raises(BenchmarkError, match=r'robots/bell \{"max_segments": 0\}: max_segments must be'):
        record(Subject(subject.name, subject.path, {"max_segments": 0}))
    subject.path.write_bytes(b"ply")
    with pytest.raises(BenchmarkError, match="Model assets/robots/bell cannot be read"):
        record(subject)
