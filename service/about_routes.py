"""What this installation takes and gives: formats, parameters and limits."""

from typing import Any

from fastapi import APIRouter

import segcore.io
from segcore.parameters import parameters_schema
from service.context import ContextOf
from service.documents import FormatDocument, FormatsDocument

router = APIRouter(prefix="/v1", tags=["about"])

_LABELS = [FormatDocument(name="json", title="JSON", extensions=[".json"], media_types=["application/json"])]
_MODELS = [FormatDocument(name="glb", title="GLB", extensions=[".glb"], media_types=["model/gltf-binary"])]


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
        labels=_LABELS,
        models=_MODELS,
        max_upload_bytes=context.settings.max_upload_bytes,
        max_faces=context.settings.max_faces,
    )


@router.get("/methods", response_model=dict[str, Any])
async def get_methods() -> dict[str, Any]:
    """The JSON Schema of the parameters of a job, with defaults, ranges and descriptions."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "Parameters", **parameters_schema()}
