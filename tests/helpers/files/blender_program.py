"""Runs Blender, the wheel ``bpy``, which is not a dependency of the tests."""

import importlib.util
import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

needs_blender = pytest.mark.skipif(importlib.util.find_spec("bpy") is None, reason="bpy is not installed")


def blender_reads(paths: Sequence[Path], folder: Path) -> dict[str, list[dict[str, Any]]]:
    """The parts that Blender finds in files, by their paths; see :mod:`helpers.files.blender`."""
    program, answer = Path(__file__).with_name("blender.py"), folder / "answer.json"
    request = json.dumps([str(path) for path in paths])
    command = [sys.executable, str(program), str(answer)]
    subprocess.run(command, input=request, text=True, capture_output=True, timeout=240, check=True)
    found: dict[str, list[dict[str, Any]]] = json.loads(answer.read_text())
    return found
