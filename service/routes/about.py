"""What this installation takes and gives: formats, parameters and limits."""

from typing import Any

from fastapi import APIRouter

import segcore.io
from segcore.io.writing import WRITERS
from segcore.parameters import parameters_schema
from service.answer.label_formats import LABELS
from service.context import ContextOf
from service.documents import FormatDocument, FormatsDocument

router = APIRouter(prefix="/v1", tags=["about"])

_MODELS = ("glb", "ply", "obj", "3mf", "zip")  # of WRITERS


@router.get("/formats", response_model=FormatsDocument)
async def get_formats(context: ContextOf) -> FormatsDocument:
    """The formats of meshes that can be sent and of results that can be fetched."""
    return FormatsDocument(
        meshes=[
            FormatDocument(
                name=name, title=form.title, extensions=list(form.extensions), media_types=list(form.media_types)
            )
            for name, form in segcore.io.FORMATS.items()
        ],
        labels=[
            FormatDocument(
                name=name,
                title=form.title,
                extensions=[form.extension],
                media_types=[form.media_type.partition(";")[0]],
            )
            for name, form in LABELS.items()
        ],
        models=[
            FormatDocument(
                name=name,
                title=WRITERS[name].title,
                extensions=[WRITERS[name].extension],
                media_types=[WRITERS[name].media_type],
            )
            for name in _MODELS
        ],
        max_upload_bytes=context.settings.max_upload_bytes,
        max_faces=context.settings.max_faces,
    )


@router.get("/methods", response_model=dict[str, Any])
async def get_methods() -> dict[str, Any]:
    """The JSON Schema of the parameters of a job, with defaults, ranges and descriptions."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "Parameters", **parameters_schema()}
