"""`cleave segment`: a mesh file in, its parts out, without a server."""

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO

import segcore
from segcore.io.glb import write_glb
from segcore.io.labels import hierarchy_document, write_seg
from segcore.io.result import write_result
from service.progress_bar import ProgressBar
from worker.durable import replace_file


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentRequest:
    """What the command line asked for; a path that is None is not written."""

    mesh: Path
    segments: int | None
    parameters: dict[str, object]
    model: Path | None
    labels: Path | None
    hierarchy: Path | None
    result: Path | None


def segment_file(request: SegmentRequest) -> list[str]:
    """Segment a file, write what was asked for, and sum up in a few lines what came out.

    Raises
    ------
    CleaveError
        Where the mesh or a parameter cannot be used.
    OSError
        Where a file cannot be read or written.
    """
    parameters = _parameters(request)
    _check_folders(request)
    with ProgressBar(sys.stderr) as bar:
        bar("prepare", 0.0)
        segcore.warm_up()
        bar("read", 0.0)
        mesh = segcore.read_mesh(request.mesh)
        hierarchy = segcore.segment(mesh, parameters, bar)
        labels = hierarchy.labels(request.segments)
        written = _write(request, mesh, hierarchy)
    chosen = "chosen automatically" if request.segments is None else "as asked"
    return [
        f"{request.mesh.name}: {len(mesh.faces)} faces, {len(mesh.vertices)} vertices",
        f"{labels.max() + 1} segments, {chosen}; 1 to {hierarchy.max_segments} are possible",
        *(f"wrote {path}" for path in written),
    ]


def _parameters(request: SegmentRequest) -> segcore.SegmentationParameters:
    """The number of segments that is wanted must be within the hierarchy, also where nobody said how far it goes."""
    parameters = segcore.SegmentationParameters.from_mapping(request.parameters)
    if request.segments is None:
        return parameters
    if request.segments < 1:
        raise segcore.InvalidParameters(f"The number of segments must be at least 1, not {request.segments}.")
    return replace(parameters, max_segments=max(parameters.max_segments, request.segments))


def _check_folders(request: SegmentRequest) -> None:
    """Say before the work, not after it, that a file could not be written."""
    for path in (request.model, request.labels, request.hierarchy, request.result):
        if path is not None and not path.parent.is_dir():
            raise NotADirectoryError(20, "There is no such folder", str(path.parent))


def _write(request: SegmentRequest, mesh: segcore.Mesh, hierarchy: segcore.Hierarchy) -> list[Path]:
    document = hierarchy_document(hierarchy)
    writers: list[tuple[Path | None, Callable[[BinaryIO], object]]] = [
        (request.model, lambda target: write_glb(target, mesh, hierarchy, request.segments)),
        (request.labels, lambda target: write_seg(target, hierarchy.labels(request.segments))),
        (request.hierarchy, lambda target: target.write(json.dumps(document, allow_nan=False).encode())),
        (request.result, lambda target: write_result(target, mesh, hierarchy)),
    ]
    for path, write in writers:
        if path is not None:
            _write_file(path, write)
    return [path for path, _ in writers if path is not None]


def _write_file(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a file whole or not at all; what is not a file, a pipe for instance, is written as it is."""
    if path.exists() and not path.is_file():
        with path.open("wb") as target:
            write(target)
    else:
        replace_file(path.resolve(), write)
