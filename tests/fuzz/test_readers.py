"""Every reader returns a valid mesh or a typed error for any file, with and without its appearance, soon.

Short by default. ``CLEAVE_FUZZ_SECONDS=600 pytest tests/fuzz`` takes 600 seconds for each reader, with new examples in
every run; ``CLEAVE_FUZZ_SEED`` repeats a run.
"""

import json
import os
import resource
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

from helpers.files.mutations import changed, mutated, mutated_set
from helpers.files.polygon_soups import read_or_none
from helpers.files.samples import gltf_with_buffer
from segcore.errors import CleaveError
from segcore.io import FORMATS, read_mesh
from segcore.mesh import Mesh

T = TypeVar("T")

SECONDS = float(os.environ.get("CLEAVE_FUZZ_SECONDS", "0"))
FIRST_SEED = int(os.environ.get("CLEAVE_FUZZ_SEED", str(time.time_ns() if SECONDS else 1)))
EXAMPLES = 300  # for each seed
MOST_SECONDS = 10  # for one file; the files have less than 30 KB
MOST_KILOBYTES = 2**20  # of growth of the memory, with the kernels that are compiled


@pytest.mark.timeout(SECONDS + 300)
@pytest.mark.parametrize("name", FORMATS)
def test_whatever_comes_gives_a_valid_mesh_or_a_typed_error(name: str) -> None:
    def check(data: bytes) -> None:
        for form in (None, name):
            mesh = read_or_none(data, form)
            dressed = read_or_none(data, form, appearance=True)
            assert_equal_and_valid(mesh, dressed)

    fuzz(mutated(name), check)


@pytest.mark.timeout(SECONDS + 300)
def test_whatever_is_in_an_archive_gives_a_valid_mesh_or_a_typed_error() -> None:
    fuzz(mutated_set(), lambda data: assert_equal_and_valid(read_or_none(data), read_or_none(data, appearance=True)))


@pytest.mark.timeout(SECONDS + 300)
def test_whatever_is_in_a_folder_gives_a_valid_mesh_or_a_typed_error(tmp_path: Path) -> None:
    path, buffer = tmp_path / "scene.gltf", tmp_path / "scene.bin"
    text, binary = gltf_with_buffer(buffer.name)
    assert json.loads(text)["buffers"][0]["uri"] == buffer.name

    def check(files: tuple[bytes, bytes]) -> None:
        path.write_bytes(files[0])
        buffer.write_bytes(files[1])
        for source in (path, tmp_path):
            assert_equal_and_valid(*(read_folder_or_none(source, appearance) for appearance in (False, True)))

    fuzz(st.tuples(damaged(text), damaged(binary)), check)


@st.composite
def damaged(draw: st.DrawFn, data: bytes) -> bytes:
    return changed(draw, data, "gltf") if draw(st.booleans()) else data


def read_folder_or_none(source: Path, appearance: bool) -> Mesh | None:
    try:
        return read_mesh(source, appearance=appearance, neighbours=True)
    except CleaveError:
        return None


def assert_equal_and_valid(mesh: Mesh | None, dressed: Mesh | None) -> None:
    assert (mesh is None) == (dressed is None)
    if mesh is not None and dressed is not None:
        assert 0 <= mesh.faces.min() <= mesh.faces.max() < len(mesh.vertices)
        assert np.isfinite(mesh.vertices[mesh.faces]).all()
        np.testing.assert_array_equal(dressed.vertices, mesh.vertices)
        np.testing.assert_array_equal(dressed.faces, mesh.faces)


def fuzz(files: st.SearchStrategy[T], check: Callable[[T], None]) -> None:
    """Check files until the time is over, at least once."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    ends_at = time.monotonic() + SECONDS
    number = FIRST_SEED
    while True:
        _fuzz_once(files, check, number)
        number += 1
        if time.monotonic() >= ends_at:
            break
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < MOST_KILOBYTES


def _fuzz_once(files: st.SearchStrategy[T], check: Callable[[T], None], number: int) -> None:
    @seed(number)
    @settings(
        max_examples=EXAMPLES, derandomize=False, database=None, deadline=None, suppress_health_check=list(HealthCheck)
    )
    @given(files)
    def timed(data: T) -> None:
        begin = time.process_time()
        check(data)
        assert time.process_time() - begin < MOST_SECONDS

    try:
        timed()
    except BaseException as error:
        error.add_note(f"Repeat it with CLEAVE_FUZZ_SEED={number}.")
        raise
