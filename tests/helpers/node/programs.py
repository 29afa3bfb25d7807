"""Programs of Node that read files for the tests, each in a folder with its lock file."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

_HERE = Path(__file__).parent


def install(name: str, folder: Path) -> Path:
    """Copy the program ``name`` to ``folder`` and install its packages; skip the test if that fails, except in CI."""
    npm = shutil.which("npm")
    if (npm is None or shutil.which("node") is None) and "CI" not in os.environ:
        pytest.skip(f"{name} needs node and npm")
    for file in (_HERE / name).iterdir():
        if file.is_file():
            shutil.copy(file, folder)
    command = [npm or "npm", "ci", "--no-audit", "--no-fund", "--ignore-scripts", "--loglevel=error"]
    installed = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    if installed.returncode and "CI" not in os.environ:
        pytest.skip(f"the packages of {name} could not be installed: {installed.stderr.strip()[-200:]}")
    assert installed.returncode == 0, installed.stderr
    return folder


def run(script: Path, arguments: list[str], text: str = "") -> str:
    """Run a script and return its output."""
    command = ["node", str(script), *arguments]
    done = subprocess.run(command, input=text, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout
