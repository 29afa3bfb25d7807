"""A session in Blender, in a process of its own with settings of its own."""

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from helpers.documents import blocks, read

needs_blender = pytest.mark.skipif(
    importlib.util.find_spec("bpy") is None, reason="bpy is not installed: pip install '.[blender-test]'"
)
_DOCUMENT = Path("docs/how-to/blender.md")
_SCENARIO = Path(__file__).with_name("scenario.py")


def run_scenario(archive: Path, url: str, api_key: str, folder: Path) -> dict[str, Any]:
    """Return what the scenario has seen of the extension; see :mod:`helpers.blender.scenario`."""
    target, script = folder / "seen.json", folder / "script.py"
    (block,) = blocks(read(_DOCUMENT), "python")
    script.write_text(block)
    environment = os.environ | {"BLENDER_USER_RESOURCES": str(folder / "settings")}
    command = [sys.executable, str(_SCENARIO), str(archive), url, api_key, str(script), str(target)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, done.stdout + done.stderr
    seen: dict[str, Any] = json.loads(target.read_text())
    return seen
