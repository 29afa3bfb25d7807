"""Measures one reader or writer in its own process: ``python -m bench.formats.probe PROGRAM read|write PATH``.

With ``serve`` in place of these, measures Cleave for each line of the input, ``read``, ``look`` or ``write`` and a
path: ``look`` reads with the appearance. The file can be run by another version of Cleave, and imports it alone.
"""

import json
import sys
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

_REPEATS = 5  # the least time of these counts, because other programs run on the machine
_SLICES = 8  # segments of the hierarchy that is written, about as many as people make of a model


def torus(faces: int) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices, exact in float32, and faces of a torus with about this number of faces."""
    minor = max(3, round((faces / 4) ** 0.5))
    major = max(3, round(faces / 2 / minor))
    u, v = np.meshgrid(2 * np.pi * np.arange(major) / major, 2 * np.pi * np.arange(minor) / minor, indexing="ij")
    ring = 1 + 0.3 * np.cos(v)
    vertices = np.stack([ring * np.cos(u), ring * np.sin(u), 0.3 * np.sin(v)], axis=-1).reshape(-1, 3)
    index = np.arange(major * minor).reshape(major, minor)
    right, up = np.roll(index, -1, axis=0), np.roll(index, -1, axis=1)
    across = np.roll(right, -1, axis=1)
    corners = np.stack([index, right, across, index, across, up], axis=-1)
    return vertices.astype(np.float32).astype(np.float64), corners.reshape(-1, 3).astype(np.int32)


def _measure(work: Callable[[], object]) -> dict[str, float]:
    """Return the least CPU seconds of some runs, and the growth of the peak memory in the first of them, in bytes."""
    Path("/proc/self/clear_refs").write_text("5")  # resets the peak, see proc(5)
    before = _status("VmRSS")
    seconds = []
    peak = 0
    for repeat in range(_REPEATS):
        begin = time.process_time()
        work()
        seconds.append(time.process_time() - begin)
        peak = _status("VmHWM") if repeat == 0 else peak
    return {"seconds": min(seconds), "peak": peak - before}


def _status(name: str) -> int:
    text = Path("/proc/self/status").read_text()
    return 1024 * int(text.split(f"{name}:")[1].split()[0])


def _reader(program: str, path: Path, appearance: bool = False) -> Callable[[], object]:
    if program == "trimesh":
        import trimesh

        return lambda: trimesh.load_scene(path, process=False)
    from segcore.io import read_mesh

    return lambda: read_mesh(path, appearance=appearance)


def _writer(path: Path) -> Callable[[], object]:
    from segcore.io.writing import writer_for

    mesh, hierarchy = _segmented(path.with_suffix(".ply"))
    writer = writer_for(path.name)
    options = {"capped": False} if "capped" in writer.options else {}  # the same work in every version

    def write() -> None:
        with path.open("wb") as target:
            writer.write(target, mesh, hierarchy, None, **options)

    return write


@cache
def _segmented(path: Path) -> tuple[Any, Any]:
    """The mesh of a file, and a hierarchy of it."""
    from segcore.hierarchy import Hierarchy
    from segcore.io import read_mesh

    mesh = read_mesh(path)
    splits = np.arange(_SLICES - 1)
    leaf = np.minimum(2 * np.arange(_SLICES) + 1, 2 * _SLICES - 2)
    share = len(mesh.faces) // _SLICES + 1
    face_leaf = leaf[np.arange(len(mesh.faces)) // share].astype(np.int32)
    counts = np.bincount(face_leaf, minlength=2 * _SLICES - 1)
    hierarchy = Hierarchy(
        split_node=np.concatenate([[0], 2 * splits[:-1] + 2]).astype(np.int32),
        cut_value=np.ones(_SLICES - 1),
        area=counts.astype(np.float64),
        face_count=counts.astype(np.int32),
        face_leaf=face_leaf,
        automatic_segments=_SLICES,
    )
    return mesh, hierarchy


def _work(action: str, path: Path) -> Callable[[], object]:
    return _writer(path) if action == "write" else _reader("cleave", path, appearance=action == "look")


def _serve() -> None:
    """Answer each line with the CPU seconds of one run, after one on the small file for a new one."""
    seen = set()
    for line in sys.stdin:
        action, name = line.rstrip("\n").split(" ", 1)
        if line not in seen:
            _work(action, Path(name).with_stem("small"))()
            seen.add(line)
        work = _work(action, Path(name))
        begin = time.process_time()
        work()
        print(json.dumps({"seconds": time.process_time() - begin}), flush=True)


def main(arguments: list[str]) -> None:
    if arguments == ["serve"]:
        _serve()
        return
    program, action, name = arguments
    path = Path(name)
    work = _reader(program, path.with_stem("small")) if action == "read" else _writer(path.with_stem("small"))
    work()  # imports and compiles what the measured runs need
    work = _reader(program, path) if action == "read" else _writer(path)
    print(json.dumps(_measure(work)))


if __name__ == "__main__":
    main(sys.argv[1:])
