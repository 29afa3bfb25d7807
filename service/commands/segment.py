"""`cleave segment`: a mesh file in, its parts out, without a server."""

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO

import segcore
from segcore.io.labels import hierarchy_document, write_seg
from segcore.io.result import write_result
from segcore.levels import Fineness
from service.commands.outputs import OutputOptions, check_outputs, write_file, write_model
from service.commands.progress_bar import ProgressBar


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentRequest:
    """What the command line asked for; a path that is None is not written."""

    mesh: Path
    fineness: Fineness
    parameters: dict[str, object]
    outputs: tuple[Path, ...]  # in the formats that their extensions name
    options: OutputOptions
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
    check_outputs([*request.outputs, *_named_outputs(request)])
    with ProgressBar(sys.stderr) as bar:
        bar("prepare", 0.0)
        segcore.warm_up()
        bar("read", 0.0)
        mesh = segcore.read_mesh(request.mesh, appearance=True)
        hierarchy = segcore.segment(mesh, parameters, bar)
        segments = request.fineness.segments_of(hierarchy)
        written = _write(request, mesh, hierarchy, segments)
    chosen = "chosen automatically" if request.fineness.is_automatic else "as asked"
    return [
        f"{request.mesh.name}: {len(mesh.faces)} faces, {len(mesh.vertices)} vertices",
        f"{segments} segments, {chosen}; 1 to {hierarchy.max_segments} are possible",
        *(f"wrote {path}" for path in written),
    ]


def _parameters(request: SegmentRequest) -> segcore.SegmentationParameters:
    """The number of segments that is wanted must be within the hierarchy, also where nobody said how far it goes."""
    parameters = segcore.SegmentationParameters.from_mapping(request.parameters)
    wanted = request.fineness.segments
    if wanted is None:
        return parameters
    if wanted < 1:
        raise segcore.InvalidParameters(f"The number of segments must be at least 1, not {wanted}.")
    return replace(parameters, max_segments=max(parameters.max_segments, wanted))


def _named_outputs(request: SegmentRequest) -> list[Path]:
    return [path for path in (request.labels, request.hierarchy, request.result) if path is not None]


def _write(request: SegmentRequest, mesh: segcore.Mesh, hierarchy: segcore.Hierarchy, segments: int) -> list[Path]:
    for model in request.outputs:
        write_model(model, mesh, hierarchy, segments, request.options)
    document = hierarchy_document(hierarchy)
    writers: list[tuple[Path | None, Callable[[BinaryIO], object]]] = [
        (request.labels, lambda target: write_seg(target, hierarchy.labels(segments))),
        (request.hierarchy, lambda target: target.write(json.dumps(document, allow_nan=False).encode())),
        (request.result, lambda target: write_result(target, mesh, hierarchy)),
    ]
    for path, write in writers:
        if path is not None:
            write_file(path, write)
    return [*request.outputs, *_named_outputs(request)]
