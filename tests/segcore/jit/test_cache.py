"""segcore is imported and computes even if neither its folder nor the home of its user can be written."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import segcore

SCRIPT = """
import numba, numpy, segcore
from segcore.array_kernels import dot
print(dot(numpy.ones(80), numpy.ones(80)), numba.config.CACHE_DIR)
"""


@pytest.fixture
def installation(tmp_path: Path) -> Path:
    """A copy of the package that cannot be written: a file stands in the place of every folder for its kernels."""
    copy = tmp_path / "installation"
    shutil.copytree(Path(segcore.__file__).parent, copy / "segcore", ignore=shutil.ignore_patterns("__pycache__"))
    for folder in [copy / "segcore", *(path for path in (copy / "segcore").rglob("*") if path.is_dir())]:
        (folder / "__pycache__").touch()
    return copy


def run(installation: Path, temporary: Path) -> "subprocess.CompletedProcess[str]":
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("NUMBA", "XDG"))}
    environment |= {"HOME": "/dev/null/nowhere", "TMPDIR": str(temporary), "PYTHONPATH": str(installation)}
    command = [sys.executable, "-B", "-c", SCRIPT]
    return subprocess.run(command, env=environment, cwd=installation, capture_output=True, text=True, check=False)


def test_kernels_are_kept_in_the_temporary_folder_if_nothing_else_can_be_written(
    installation: Path, tmp_path: Path
) -> None:
    done = run(installation, tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["80.0", str(tmp_path / f"cleave-kernels-{os.getuid()}")]
    assert done.stderr == ""
    assert list((tmp_path / f"cleave-kernels-{os.getuid()}").rglob("*.nbi"))


def test_kernels_are_compiled_each_time_with_a_word_if_a_cache_would_not_be_safe(
    installation: Path, tmp_path: Path
) -> None:
    open_to_all = tmp_path / f"cleave-kernels-{os.getuid()}"
    open_to_all.mkdir()
    open_to_all.chmod(0o777)
    done = run(installation, tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split()[0] == "80.0"
    assert "kernels are compiled in every process" in done.stderr
    assert "NUMBA_CACHE_DIR" in done.stderr
