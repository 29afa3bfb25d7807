"""Formats, parameters and limits of this installation."""

from typing import Any

from fastapi import APIRouter

from segcore.io import FORMATS, Writer
from segcore.parameters import parameters_schema
from service.answer.label_formats import LABELS, LabelsEncoding
from service.answer.model_formats import MODELS
from service.context import ContextOf
from service.documents import FormatDocument, FormatsDocument

router = APIRouter(prefix="/v1", tags=["about"])


@router.get("/formats", response_model=FormatsDocument)
async def get_formats(context: ContextOf) -> FormatsDocument:
    """The formats of uploads and of results."""
    return FormatsDocument(
        meshes=[
            FormatDocument(
                name=name, title=one.title, extensions=list(one.extensions), media_types=list(one.media_types)
            )
            for name, one in FORMATS.items()
        ],
        labels=[_result_format(name, encoding) for name, encoding in LABELS.items()],
        models=[_result_format(name, writer) for name, writer in MODELS.items()],
        max_upload_bytes=context.settings.max_upload_bytes,
        max_faces=context.settings.max_faces,
        keys_required=context.keys_required,
        version=context.version,
    )


@router.get("/methods", response_model=dict[str, Any])
async def get_methods() -> dict[str, Any]:
    """The JSON Schema of the parameters of a job, with defaults, ranges and descriptions."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "Parameters", **parameters_schema()}


def _result_format(name: str, form: LabelsEncoding | Writer) -> FormatDocument:
    media_type = form.media_type.partition(";")[0]
    return FormatDocument(name=name, title=form.title, extensions=[form.extension], media_types=[media_type])
