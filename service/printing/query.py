"""The query parameters of files for printing."""

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Query

from segcore.coordinates import Axis
from segcore.printing.options import (
    BED_PATTERN,
    CLEARANCE,
    LARGEST_CLEARANCE,
    LARGEST_LENGTH,
    MOST_SLOTS,
    Connectors,
    Place,
    PrintOptions,
    Slicer,
)


@dataclass(frozen=True, slots=True)
class PrintRequest:
    """What a request wants to be printed."""

    options: PrintOptions
    up: Axis | None  # of the mesh, if it does not name it


async def _request(
    connectors: Annotated[
        Connectors,
        Query(description="Dowels, each for two holes, pegs that are a piece of one of two parts, or none."),
    ] = "dowel",
    clearance: Annotated[
        float,
        Query(ge=0, le=LARGEST_CLEARANCE, description="The diameter of a hole minus that of what fits into it, in mm."),
    ] = CLEARANCE,
    bed: Annotated[
        str | None,
        Query(
            pattern=BED_PATTERN,
            description="Width, depth and height of the bed in mm, at least 50 each; larger parts are divided.",
            examples=["250x250x250"],
        ),
    ] = None,
    slots: Annotated[
        int | None,
        Query(
            ge=1,
            le=MOST_SLOTS,
            description="The number of filaments: similar colours are joined. By default all colours.",
        ),
    ] = None,
    size: Annotated[
        float | None,
        Query(
            gt=0,
            le=LARGEST_LENGTH,
            description="The longest side of the whole in mm; by default that of the mesh. Lengths of a mesh whose "
            "unit is not known are taken as mm.",
        ),
    ] = None,
    place: Annotated[
        Place, Query(description="Objects side by side, each on the bed as it stands, or assembled as in the mesh.")
    ] = "plate",
    slicer: Annotated[
        Slicer,
        Query(
            description="The slicer for which the file names the extruder of every object: PrusaSlicer, or Bambu "
            "Studio and OrcaSlicer. By default materials only, which every reader of 3MF knows."
        ),
    ] = "any",
    up: Annotated[
        Axis | None,
        Query(description="The axis that points up, y or z, if the mesh does not name it; by default z."),
    ] = None,
) -> PrintRequest:
    options = PrintOptions(
        connectors=connectors,
        clearance=clearance,
        bed=bed,
        slots=slots,
        size=size,
        place=place,
        slicer=slicer,
    )
    return PrintRequest(options, up)


PrintRequestOf = Annotated[PrintRequest, Depends(_request)]
