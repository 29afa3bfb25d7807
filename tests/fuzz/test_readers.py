"""Every reader returns a valid mesh or a typed error for any file, with and without its appearance.

Short by default. ``CLEAVE_FUZZ_SECONDS=600 pytest tests/fuzz`` takes 600 seconds for each reader, with new examples in
every run; ``CLEAVE_FUZZ_SEED`` repeats a run.
"""

import os
import time

import numpy as np
import pytest
from hypothesis import HealthCheck, given, seed, settings

from helpers.files.mutations import mutated
from helpers.files.polygon_soups import read_or_none
from segcore.io import FORMATS

SECONDS = float(os.environ.get("CLEAVE_FUZZ_SECONDS", "0"))
FIRST_SEED = int(os.environ.get("CLEAVE_FUZZ_SEED", str(time.time_ns() if SECONDS else 1)))
EXAMPLES = 300  # for each seed


@pytest.mark.timeout(SECONDS + 300)
@pytest.mark.parametrize("name", FORMATS)
def test_whatever_comes_gives_a_valid_mesh_or_a_typed_error(name: str) -> None:
    ends_at = time.monotonic() + SECONDS
    number = FIRST_SEED
    while True:
        fuzz(name, number)
        number += 1
        if time.monotonic() >= ends_at:
            break


def fuzz(name: str, number: int) -> None:
    @seed(number)
    @settings(
        max_examples=EXAMPLES, derandomize=False, database=None, deadline=None, suppress_health_check=list(HealthCheck)
    )
    @given(mutated(name))
    def check(data: bytes) -> None:
        for form in (None, name):
            mesh = read_or_none(data, form)
            dressed = read_or_none(data, form, appearance=True)
            assert (mesh is None) == (dressed is None)
            if mesh is not None and dressed is not None:
                assert np.isfinite(mesh.vertices).all()
                assert 0 <= mesh.faces.min() <= mesh.faces.max() < len(mesh.vertices)
                np.testing.assert_array_equal(dressed.vertices, mesh.vertices)
                np.testing.assert_array_equal(dressed.faces, mesh.faces)

    try:
        check()
    except BaseException as error:
        error.add_note(f"Repeat it with CLEAVE_FUZZ_SEED={number}.")
        raise
