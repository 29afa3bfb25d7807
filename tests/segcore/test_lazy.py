"""Modules that are imported when they are used."""

import subprocess
import sys
from pathlib import Path

SCRIPT = """
import sys, types
from segcore.lazy import import_later

import_later("made.slow")
import_later("made.slow")
from made import *
assert isinstance(slow, types.ModuleType) and events == []
import made.slow
assert made.slow is slow and made.slow.answer == 42 and events == ["slow"]
import_later("made.slow")
assert sys.modules["made.slow"] is slow and slow.answer == 42 and events == ["slow"]
"""


def test_a_module_is_imported_when_an_attribute_is_used(tmp_path: Path) -> None:
    (tmp_path / "made").mkdir()
    (tmp_path / "made/__init__.py").write_text("events = []\n__all__ = ['events', 'slow']\n")
    (tmp_path / "made/slow.py").write_text("import made\nmade.events.append('slow')\nanswer = 42\n")
    subprocess.run([sys.executable, "-c", SCRIPT], cwd=tmp_path, check=True)


def test_the_core_leaves_numpys_fortran_tools_alone_and_usable() -> None:
    script = """
import sys
from segcore.array_kernels import dot
import numpy, scipy.spatial
assert "numpy.f2py.crackfortran" not in sys.modules
assert callable(numpy.f2py.run_main) and "numpy.f2py.crackfortran" in sys.modules
"""
    subprocess.run([sys.executable, "-c", script], check=True)
