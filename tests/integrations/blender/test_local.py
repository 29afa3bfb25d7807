"""Cleave runs in a process of another Python, which tells what is missing and can be ended."""

import sys
from pathlib import Path

import numpy as np
import pytest

import segcore
from integrations.blender.errors import CanceledError, CleaveError
from integrations.blender.local import LocalPython
from integrations.blender.polygons import Polygons
from integrations.blender.work import Watch
from segcore.shapes import burr

_MESH = burr(3).mesh
_SIZES = np.full(len(_MESH.faces), 3, dtype=np.int32)
_PLY = Polygons(_MESH.vertices.astype(np.float32), _MESH.faces.ravel(), _SIZES).ply()
_ROOT = str(Path(segcore.__file__).parents[1])
_HERE = LocalPython(sys.executable, packages=_ROOT)


def test_the_levels_are_those_of_segcore() -> None:
    watch = Watch(200)
    levels = _HERE.segment(_PLY, len(_MESH.faces), "burr", watch)
    hierarchy = segcore.segment(segcore.Mesh(_MESH.vertices.astype(np.float32), _MESH.faces))
    assert levels.automatic == hierarchy.automatic_segments
    for segments in (1, 7, hierarchy.max_segments):
        assert np.array_equal(levels.labels(segments), hierarchy.labels(segments))


def test_a_python_without_cleave_tells_how_to_install_it() -> None:
    bare = LocalPython(sys.executable, ("-I", "-S"), packages="/nowhere/packages")
    command = f'"{sys.executable}" -m pip install --target "/nowhere/packages" cleave-mesh'
    with pytest.raises(CleaveError, match="Cleave is not installed in this Python") as caught:
        bare.segment(_PLY, len(_MESH.faces), "burr", Watch(60))
    assert str(caught.value).endswith(command)
    assert LocalPython("python3").install_command() == '"python3" -m pip install cleave-mesh'


def test_a_mesh_that_cannot_be_segmented_is_named() -> None:
    broken = Polygons(np.zeros((3, 3), dtype=np.float32), np.int32([0, 1, 9]), np.int32([3])).ply()
    with pytest.raises(CleaveError, match=r"^flat: .*vert"):
        _HERE.segment(broken, 1, "flat", Watch(60))


def test_a_python_that_cannot_be_started_is_named(tmp_path: Path) -> None:
    nothing = str(tmp_path / "python")
    with pytest.raises(CleaveError, match=r"cannot be started .*set Python in the preferences"):
        LocalPython(nothing).segment(_PLY, len(_MESH.faces), "burr", Watch(60))
    with pytest.raises(CleaveError, match=r"^burr: the computation ended with status 1: no message$"):
        LocalPython("/bin/false").segment(_PLY, len(_MESH.faces), "burr", Watch(60))


def test_stopped_work_leaves_no_process(tmp_path: Path) -> None:
    class Stopped(Watch):
        """Stops when the process runs."""

        def pause(self, seconds: float) -> None:
            self.stop()
            super().pause(seconds)

    started = tmp_path / "python"
    started.write_text(f"#!/bin/sh\necho $$ > {tmp_path}/pid\nexec sleep 100\n")
    started.chmod(0o755)
    with pytest.raises(CanceledError):
        LocalPython(str(started)).segment(_PLY, len(_MESH.faces), "burr", Stopped(60))
    with pytest.raises(CleaveError, match=r"Not finished after 0\.5 s"):
        LocalPython(str(started)).segment(_PLY, len(_MESH.faces), "burr", Watch(0.5))
    number = (tmp_path / "pid").read_text().strip()
    assert not Path(f"/proc/{number}").exists()
