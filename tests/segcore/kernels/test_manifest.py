"""The list of kernels has exactly what is called, and what real segmentations need."""

import json
import subprocess
import sys

import pytest

from segcore.kernels.manifest import GROUPS, PATH, SEGMENT, kernels
from segcore.kernels.signatures import named

_RECORD = """
import json, segcore
from dataclasses import asdict
from segcore.kernels.recording import recorded
print(json.dumps([asdict(kernel) for kernel in recorded()]))
"""
_SEGMENT = """
import json, segcore
from segcore.kernels.recording import called
from segcore.shapes import dumbbell
segcore.segment(dumbbell(rings=60, around=30).mesh)
print(json.dumps([[kernel.place, kernel.arguments] for kernel in called("segment")]))
"""


def answer(script: str) -> list[object]:
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    found: list[object] = json.loads(done.stdout)
    return found


@pytest.fixture(scope="module", autouse=True)
def _compiled() -> None:
    subprocess.run([sys.executable, "-c", "import segcore; segcore.warm_up()"], check=True)


def test_the_list_is_what_the_tasks_of_each_group_call() -> None:
    """If this fails, run ``python -m segcore.kernels.recording`` and commit the list."""
    assert answer(_RECORD) == json.loads(PATH.read_text())


def test_a_segmentation_with_the_default_parameters_calls_kernels_of_its_group_alone() -> None:
    first = [[kernel.place, kernel.arguments] for kernel in kernels() if kernel.group == SEGMENT]
    called = answer(_SEGMENT)
    assert called
    assert [kernel for kernel in called if kernel not in first] == []


def test_every_group_has_kernels_and_every_entry_is_a_signature() -> None:
    assert {kernel.group for kernel in kernels()} == set(GROUPS)
    for kernel in kernels():
        assert named(kernel.place).py_func.__module__ == kernel.place.partition(":")[0]
    assert PATH.read_text().count("\n") == len(kernels()) + 2
