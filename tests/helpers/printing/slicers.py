"""Programs that read files for printing: a test that needs one is skipped if it is missing, except in CI."""

import os
import shutil

import pytest

from bench.printing.slicer import PROGRAM

needs_slicer = pytest.mark.skipif(
    shutil.which(PROGRAM) is None and "CI" not in os.environ, reason=f"{PROGRAM} is not installed"
)
