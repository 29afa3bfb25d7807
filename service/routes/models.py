"""The segmented mesh as files for other programs, with a route per format of MODELS."""

from collections.abc import Awaitable, Callable
from inspect import Parameter, Signature
from typing import Annotated, Any, Literal, get_args

from fastapi import APIRouter, Depends, Query
from starlette.responses import Response

from segcore.coordinates import Axis, Unit
from segcore.io import Layout, PartFormat, PlyColors, WriteOption, Writer
from service.answer.model_formats import MODELS, model_file, operation_name
from service.answer.models import model_rendition
from service.answer.originals import ORIGINAL_PROBLEMS
from service.answer.part_names import PartNames
from service.answer.renditions import LEVEL_PROBLEMS, answer_rendition, rendition_responses
from service.answer.result_request import ResultRequestOf
from service.answer.revision import REVISION_PROBLEMS

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["models"])

_BINARY = {"schema": {"type": "string", "format": "binary"}}

# The query parameters for the options of writers: types and defaults.
OPTIONS: dict[WriteOption, tuple[Any, object]] = {
    "all_levels": (
        Annotated[
            Literal["all"] | None,
            Query(
                alias="levels",
                description="All levels in one file: a node per node of the hierarchy, a material variant per level.",
            ),
        ],
        None,
    ),
    "features": (
        Annotated[
            bool,
            Query(description="The hierarchy as EXT_structural_metadata, referenced by EXT_mesh_features."),
        ],
        False,
    ),
    "layout": (
        Annotated[Layout, Query(description="Nodes nested as the hierarchy, or all parts below the root.")],
        "tree",
    ),
    "keep": (
        Annotated[
            Literal["all"] | None,
            Query(
                description="The file that was sent with everything that it has, divided by part: nodes, materials, "
                "textures, attributes, skins, animations. Of parts, only as glb, which always keep it; as OBJ, the "
                "materials and pictures of an OBJ file."
            ),
        ],
        None,
    ),
    "part_format": (
        Annotated[PartFormat, Query(description="The format of the files of the parts.")],
        "stl",
    ),
    "colors": (
        Annotated[
            PlyColors,
            Query(
                description="Colours of segments on the vertices, divided between segments, and on the faces; or on "
                "the faces alone, with vertices as in the input.",
            ),
        ],
        "vertices",
    ),
    "capped": (
        Annotated[
            bool | None,
            Query(
                description="Close every part at its cuts, for printing, or write the parts as they are (false). By "
                "default objects of 3MF and parts as STL are closed, and parts as OBJ are not.",
            ),
        ],
        None,
    ),
    "unit": (
        Annotated[
            str | None,
            Query(
                max_length=40,
                description="Convert the coordinates to this unit, for example mm; that of the mesh must be known.",
                json_schema_extra={"enum": list(get_args(Unit))},
            ),
        ],
        None,
    ),
    "up": (
        Annotated[
            str | None,
            Query(
                max_length=40,
                description="Turn the mesh so that this axis points up, y or z; that of the mesh must be known.",
                json_schema_extra={"enum": list(get_args(Axis))},
            ),
        ],
        None,
    ),
}

_SHORT_FORMAT = Annotated[PartFormat | None, Query(description="The same as part_format.")]


def _options_of(writer: Writer) -> Callable[..., Awaitable[dict[str, Any]]]:
    """Return a dependency that reads the options of a writer from the query."""

    async def read(**options: Any) -> dict[str, Any]:
        short = options.pop("format", None)
        if short is not None:
            options["part_format"] = short
        if "all_levels" in options:
            options["all_levels"] = options["all_levels"] == "all"
        if options.get("part_format") == "glb":
            options["keep"] = "all"
        return options

    parameters = [
        Parameter(name, Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
        for name, (annotation, default) in OPTIONS.items()
        if name in writer.options
    ]
    if "part_format" in writer.options:
        parameters.append(Parameter("format", Parameter.KEYWORD_ONLY, default=None, annotation=_SHORT_FORMAT))
    read.__signature__ = Signature(parameters)  # type: ignore[attr-defined]
    return read


def _add_route(name: str, writer: Writer) -> None:
    def get_model(
        options: Annotated[dict[str, Any], Depends(_options_of(writer))], wanted: ResultRequestOf, names: PartNames
    ) -> Response:
        rendition = model_rendition(wanted.context, wanted.cut(), name, names, options)
        return answer_rendition(wanted.request, rendition)

    problems = [*(ORIGINAL_PROBLEMS if "keep" in writer.options else ()), *["missing_package"] * bool(writer.package)]
    router.add_api_route(
        f"/{model_file(name)}",
        get_model,
        name=f"get_{operation_name(name)}",
        description=f"The segmented mesh as {writer.title}.",
        response_class=Response,
        responses=rendition_responses(
            {writer.media_type: _BINARY}, f"{writer.title}.", *LEVEL_PROBLEMS, *REVISION_PROBLEMS, *problems
        ),
    )


for _name, _writer in MODELS.items():
    _add_route(_name, _writer)
