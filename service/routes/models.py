"""The segmented mesh as files of other programs, and as a picture."""

import io
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Annotated, Any, BinaryIO, Literal

from fastapi import APIRouter, Query, Request
from starlette.responses import Response

from segcore.io.gltf.writer import write_glb
from segcore.io.obj.writer import write_obj
from segcore.io.parts.writer import write_parts
from segcore.io.picture import draw, write_png
from segcore.io.ply.writer import write_ply
from segcore.io.threemf.writer import write_3mf
from segcore.io.writing import WRITERS
from service.answer.level import Level, LevelOf
from service.answer.part_names import PartNames, named
from service.answer.renditions import Rendition, answer_rendition, rendition_responses
from service.context import Context, ContextOf
from service.guard.callers import Caller, CallerOf
from service.lookup import known_job, result_of
from service.routes.jobs import JobId
from service.routes.results import LEVEL_PROBLEMS

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["models"])

Capped = Annotated[bool, Query(description="Close every part at its cuts, for printing.")]

_PNG = "image/png"
_BINARY = {"schema": {"type": "string", "format": "binary"}}


def _responses(name: str) -> dict[int | str, dict[str, Any]]:
    writer = WRITERS[name]
    return rendition_responses({writer.media_type: _BINARY}, f"{writer.title}.") | LEVEL_PROBLEMS


@router.get("/model.glb", response_class=Response, responses=_responses("glb"))
def get_glb(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    level: LevelOf,
    names: PartNames,
    levels: Annotated[
        Literal["all"] | None,
        Query(description="Every level in one file: a node per node of the hierarchy, a material variant per level."),
    ] = None,
    features: Annotated[
        bool, Query(description="The hierarchy as EXT_structural_metadata, and EXT_mesh_features that lead to it.")
    ] = False,
) -> Response:
    """The mesh as binary glTF, a named node and a colour for every segment."""
    options = {"all_levels": levels == "all", "features": features}
    return _model(request, context, caller, job_id, "glb", level, names, write_glb, options)


@router.get("/model.ply", response_class=Response, responses=_responses("ply"))
def get_ply(
    job_id: JobId, request: Request, context: ContextOf, caller: CallerOf, level: LevelOf, names: PartNames
) -> Response:
    """The mesh as binary PLY with a colour and a label for every face."""
    return _model(request, context, caller, job_id, "ply", level, names, write_ply)


@router.get("/model.obj", response_class=Response, responses=_responses("obj"))
def get_obj(
    job_id: JobId, request: Request, context: ContextOf, caller: CallerOf, level: LevelOf, names: PartNames
) -> Response:
    """The mesh as OBJ with a group for every segment."""
    return _model(request, context, caller, job_id, "obj", level, names, write_obj)


@router.get("/model.3mf", response_class=Response, responses=_responses("3mf"))
def get_3mf(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    level: LevelOf,
    names: PartNames,
    capped: Capped = False,
) -> Response:
    """The mesh as 3MF with an object for every segment."""
    return _model(request, context, caller, job_id, "3mf", level, names, write_3mf, {"capped": capped})


@router.get("/parts.zip", response_class=Response, responses=_responses("zip"))
def get_parts(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    level: LevelOf,
    names: PartNames,
    part_format: Annotated[Literal["stl", "obj"], Query(description="The format of the files in it.")] = "stl",
    capped: Capped = False,
) -> Response:
    """A ZIP archive with a file for every segment."""
    options = {"part_format": part_format, "capped": capped}
    return _model(request, context, caller, job_id, "zip", level, names, write_parts, options)


@router.get(
    "/preview.png",
    response_class=Response,
    responses=rendition_responses({_PNG: _BINARY}, "A picture.") | LEVEL_PROBLEMS,
)
def get_preview(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    level: LevelOf,
    size: Annotated[int, Query(ge=16, le=1024, description="Width and height in pixels.")] = 256,
) -> Response:
    """A picture of the mesh in the colours of its segments, on a transparent ground."""
    job = known_job(context, caller, job_id)
    cut = level.of(result_of(context, job))

    def render() -> bytes:
        pixels = draw(cut.result.mesh, cut.result.hierarchy.labels(cut.segments), size)
        return _written(lambda target: write_png(target, pixels))

    identity = f"{job.id}/preview.png?{cut.name}&size={size}"
    return answer_rendition(
        request,
        Rendition(
            identity=identity, media_type=_PNG, render=lambda: context.results.rendered(job.id, identity, render)
        ),
    )


def _model(
    request: Request,
    context: Context,
    caller: Caller,
    job_id: str,
    name: str,
    level: Level,
    names: dict[int, str],
    write: Callable[..., None],
    options: Mapping[str, object] = MappingProxyType({}),
) -> Response:
    """The answer with what a writer of :mod:`segcore.io` makes of a cut, under its keyword arguments ``options``."""
    job = known_job(context, caller, job_id)
    cut = level.of(result_of(context, job))
    chosen = "".join(f"&{option}={value}" for option, value in options.items())
    identity = f"{job.id}/{name}?{cut.name}{chosen}{named(names)}"

    def render() -> bytes:
        mesh, hierarchy = cut.result.mesh, cut.result.hierarchy
        return _written(lambda target: write(target, mesh, hierarchy, cut.segments, names=names, **options))

    return answer_rendition(
        request,
        Rendition(
            identity=identity,
            media_type=WRITERS[name].media_type,
            render=lambda: context.results.rendered(job.id, identity, render),
            file_name=f"{job.id}{WRITERS[name].extension}",
        ),
    )


def _written(write: Callable[[BinaryIO], object]) -> bytes:
    target = io.BytesIO()
    write(target)
    return target.getvalue()
