"""Tools that look at the parts, and that edit them by clicks on the picture."""

import json
from dataclasses import dataclass
from typing import Annotated, Any, Literal, TypeAlias

from mcp.server.mcpserver import Image
from mcp.server.mcpserver.exceptions import ToolError
from pydantic import Field

from cleave.client import AsyncClient
from service.mcp.calls import Call, Connect, JobId, edited_text, text_of
from service.mcp.job_tools import PartNumber

# Azimuth and elevation in degrees.
_SIDES = {
    "corner": (30.0, 20.0),
    "front": (0.0, 0.0),
    "right": (90.0, 0.0),
    "back": (180.0, 0.0),
    "left": (-90.0, 0.0),
    "top": (0.0, 90.0),
    "bottom": (0.0, -90.0),
}
Side: TypeAlias = Annotated[
    Literal["corner", "front", "right", "back", "left", "top", "bottom"],
    Field(description="The side that is seen; corner is the front from the right and above."),
]
Azimuth: TypeAlias = Annotated[
    float | None,
    Field(ge=-360, le=360, description="In place of that of the side: degrees about the vertical axis, 0 the front."),
]
Elevation: TypeAlias = Annotated[
    float | None, Field(ge=-90, le=90, description="In place of that of the side: degrees above the horizontal plane.")
]
Size: TypeAlias = Annotated[int, Field(ge=64, le=1024, description="Width and height of the picture in pixels.")]
Pixel: TypeAlias = Annotated[
    list[Annotated[int, Field(ge=0, le=1023)]],
    Field(min_length=2, max_length=2, description="[x, y] in pixels from the top left of the picture."),
]
Pixels: TypeAlias = Annotated[list[Pixel], Field(max_length=50)]


@dataclass(frozen=True, slots=True)
class PictureTools:
    """A click is a pixel of the picture with the same side, azimuth, elevation and size."""

    connect: Connect

    async def look(
        self,
        call: Call,
        job_id: JobId,
        side: Side = "corner",
        azimuth: Azimuth = None,
        elevation: Elevation = None,
        size: Size = 512,
    ) -> list[Image | str]:
        """Return a picture of the parts, each in its colour and with its number in it, and the list of visible parts.

        For each visible part: number, name (empty for none), the pixels in which it is seen, and x, y, a pixel that
        surely lies on it. hidden are the numbers of the parts that are not seen from this side: look from another
        one. A part with numbered false has no number in the picture because there is no room: use a larger size.
        """
        camera = _camera(side, azimuth, elevation, size)
        async with self.connect(call) as client:
            picture = await client.content(job_id, "preview.png", numbers=True, revision="latest", **camera)
            view = await _view(client, job_id, camera)
        seen = {part["number"] for part in view["parts"]}
        hidden = [number for number in range(view["segments"]) if number not in seen]
        return [Image(data=picture, format="png"), text_of({"parts": view["parts"], "hidden": hidden})]

    async def part_at(
        self,
        call: Call,
        job_id: JobId,
        at: Pixel,
        side: Side = "corner",
        azimuth: Azimuth = None,
        elevation: Elevation = None,
        size: Size = 512,
    ) -> str:
        """Return the number of the part, and of the face, that is seen at a pixel of the picture; null for background.

        Give the side, azimuth, elevation and size with which you called look.
        """
        async with self.connect(call) as client:
            view = await _view(client, job_id, _camera(side, azimuth, elevation, size), [at])
        return text_of(view["points"][0])

    async def find_part(
        self,
        call: Call,
        job_id: JobId,
        inside: Annotated[Pixels, Field(min_length=1)],
        outside: Pixels = [],  # noqa: B006
        side: Side = "corner",
        azimuth: Azimuth = None,
        elevation: Elevation = None,
        size: Size = 512,
    ) -> str:
        """Make a new part from clicks: the part that a person would mean who clicks there, whatever the parts are now.

        Use it for a part that no cut has found, such as a handle. One click inside is mostly enough; click outside
        where the new part was too large, after restore_revision. Give the side, azimuth, elevation and size with which
        you called look. Returns the new parts.
        """
        camera = _camera(side, azimuth, elevation, size)
        async with self.connect(call) as client:
            view = await _view(client, job_id, camera, inside + outside)
            faces = [point["face"] for point in view["points"]]
            if None in faces:
                raise ToolError(
                    f"There is only background at {(inside + outside)[faces.index(None)]}: click on a part."
                )
            marks = {"inside": faces[: len(inside)], "outside": faces[len(inside) :]}
            return edited_text(await client.edit(job_id, [{"op": "part", **marks}]))

    async def split_part(
        self,
        call: Call,
        job_id: JobId,
        part: PartNumber,
        line: Annotated[Pixels, Field(min_length=2)],
        side: Side = "corner",
        azimuth: Azimuth = None,
        elevation: Elevation = None,
        size: Size = 512,
    ) -> str:
        """Divide a part along a line across it in the picture; one side becomes a new part.

        line has the pixels from one outline of the part to the other; the cut goes around the part behind it. Give the
        side, azimuth, elevation and size with which you called look. Returns the new parts.
        """
        async with self.connect(call) as client:
            view = await _view(client, job_id, _camera(side, azimuth, elevation, size), line)
            operation = {"op": "cut", "part": part, "stroke": view["faces"]}
            return edited_text(await client.edit(job_id, [operation]))


def _camera(side: str, azimuth: float | None, elevation: float | None, size: int) -> dict[str, Any]:
    usual = _SIDES[side]
    return {
        "azimuth": usual[0] if azimuth is None else azimuth,
        "elevation": usual[1] if elevation is None else elevation,
        "size": size,
    }


async def _view(
    client: AsyncClient, job_id: str, camera: dict[str, Any], at: list[list[int]] | None = None
) -> dict[str, Any]:
    """Return what is seen in the picture of the newest revision, and at some pixels."""
    pixels = [f"{x},{y}" for x, y in at or []]
    view: dict[str, Any] = json.loads(await client.content(job_id, "view", revision="latest", at=pixels, **camera))
    return view
