"""Pictures of the segmented mesh from any side, and what is seen in them."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, BinaryIO

from fastapi import Query
from pydantic import BaseModel, Field

from segcore.errors import InvalidParameters
from service.answer.level import ChosenCut
from service.answer.models import cached_rendition
from service.answer.renditions import Rendition
from service.result_cache import ResultCache

if TYPE_CHECKING:  # a server starts without kernels
    from segcore.io import View

PNG = "image/png"


@dataclass(frozen=True, slots=True)
class Camera:
    """From where a picture is taken."""

    size: Annotated[int, Query(ge=16, le=1024, description="Width and height in pixels.")] = 256
    azimuth: Annotated[
        float,
        Query(
            ge=-360,
            le=360,
            description="The direction to the viewer about the vertical axis, in degrees: 0 is the front, 90 the "
            "right of the picture of the front, 180 the back.",
        ),
    ] = 30.0
    elevation: Annotated[
        float, Query(ge=-90, le=90, description="The direction to the viewer above the horizontal plane, in degrees.")
    ] = 20.0


class SeenPart(BaseModel):
    """A part that is seen in a picture."""

    number: int
    name: str = Field(description="Empty for none.", examples=["left arm"])
    pixels: int = Field(description="In which it is seen.")
    x: int = Field(description="The column of the pixel of the part that is farthest from its outline.")
    y: int = Field(description="The row of that pixel.")
    numbered: bool = Field(description="False if its number would cover that of a larger part.")


class SeenPoint(BaseModel):
    """What is seen at a pixel."""

    x: int
    y: int
    face: int | None = Field(description="Null for the background.")
    part: int | None = Field(description="Null for the background.")


class ViewDocument(BaseModel):
    """What is seen in a picture; x and y count pixels from 0 at the top left."""

    size: int = Field(examples=[512])
    segments: int = Field(description="The number of all parts, seen or not.")
    parts: list[SeenPart] = Field(description="The visible parts, in the order of their numbers.")
    points: list[SeenPoint] = Field(description="For each at of the request.")
    faces: list[int] = Field(description="The faces along the straight lines from point to point, each once.")


def preview_rendition(cache: ResultCache, cut: ChosenCut, camera: Camera, *, numbers: bool) -> Rendition:
    """Return a picture with a transparent background, or with the numbers of the parts on white."""

    def write(target: BinaryIO) -> None:
        from segcore.io import draw, write_png

        colors = None if cut.partition is None else cut.partition.colors
        if numbers:
            write_png(target, _view(cut, camera).numbered(colors))
        else:
            mesh = cut.result.mesh
            picture = draw(mesh, cut.labels, camera.size, camera.azimuth, camera.elevation, part_colors=colors)
            write_png(target, picture)

    query = f"size={camera.size}&azimuth={camera.azimuth}&elevation={camera.elevation}&numbers={numbers}"
    return cached_rendition(cache, cut, f"preview.png?{cut.name}&{query}", PNG, write)


def view_document(cut: ChosenCut, camera: Camera, at: list[str]) -> ViewDocument:
    """Return what is seen in a picture, and at some of its pixels.

    Parameters
    ----------
    at : pixels as text, ``x,y``.

    Raises
    ------
    InvalidParameters
        If the picture has no such pixel.
    """
    points = [_pixel(text) for text in at]
    view = _view(cut, camera)
    names = {} if cut.partition is None else cut.partition.names
    labels = view.labels
    faces = [view.face_at(x, y) for x, y in points]
    return ViewDocument(
        size=camera.size,
        segments=cut.segments,
        parts=[
            SeenPart(
                number=part.number,
                name=names.get(part.number, ""),
                pixels=part.pixels,
                x=part.x,
                y=part.y,
                numbered=part.is_numbered,
            )
            for part in sorted(view.visible_parts(), key=lambda part: part.number)
        ],
        points=[
            SeenPoint(x=x, y=y, face=face, part=None if face is None else int(labels[face]))
            for (x, y), face in zip(points, faces, strict=True)
        ],
        faces=view.faces_between(points),
    )


def _view(cut: ChosenCut, camera: Camera) -> "View":
    from segcore.io import view_of

    return view_of(cut.result.mesh, cut.labels, camera.size, camera.azimuth, camera.elevation)


def _pixel(text: str) -> tuple[int, int]:
    x, _, y = text.partition(",")
    if not (x.isdecimal() and y.isdecimal() and len(text) <= 11):
        raise InvalidParameters("A pixel is a column and a row, such as at=120,80.")
    return int(x), int(y)
