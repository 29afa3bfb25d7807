"""The list of parts in responses."""

from typing import BinaryIO

from pydantic import BaseModel, Field

import segcore
from segcore.part_list.document import part_list_document
from service.answer.label_formats import compact_json
from service.answer.level import ChosenCut
from service.answer.models import cached_rendition
from service.answer.renditions import Rendition
from service.result_cache import ResultCache

_Vector = list[float]


class BorderPlaneDocument(BaseModel):
    """The plane with the least sum of squared distances from a border."""

    point: _Vector = Field(min_length=3, max_length=3, description="The centroid of the border.")
    normal: _Vector = Field(min_length=3, max_length=3, description="A unit vector, to the side of the neighbour.")
    largest_deviation: float = Field(description="Of a point of the border from the plane, in units of the mesh.")


class NeighbourDocument(BaseModel):
    part: int
    length: float = Field(description="Of the common border, in units of the mesh.")
    plane: BorderPlaneDocument | None = Field(description="Null if the border is straight, so that many planes fit.")


class OrientedBoxDocument(BaseModel):
    """A box around a part, of nearly the least volume."""

    centre: _Vector = Field(min_length=3, max_length=3)
    axes: list[_Vector] = Field(min_length=3, max_length=3, description="Unit vectors along its edges, right-handed.")
    extents: _Vector = Field(
        min_length=3, max_length=3, description="Lengths of its edges, the longest first, in units of the mesh."
    )


class ListedPart(BaseModel):
    """What can be measured of a part."""

    number: int = Field(description="Its label.")
    name: str = Field(description="Empty for none.", examples=["left arm"])
    color: str = Field(description="The colour that files show.", examples=["#56b4e9"])
    faces: int
    area: float = Field(description="Of its faces, without caps, in squared units of the mesh.")
    volume: float | None = Field(
        description="Inside the part closed by caps, as it is printed, in cubed units of the mesh; null if the part "
        "cannot be closed."
    )
    why_no_volume: str | None = Field(description="A sentence, if the volume is null.")
    centre: _Vector = Field(min_length=3, max_length=3, description="The centroid of its area.")
    box: OrientedBoxDocument
    neighbours: list[NeighbourDocument] = Field(
        description="The parts that share edges with it, in the order of their numbers."
    )
    repeat: int | None = Field(description="The place of its group in repeats; null if no part is equal to it.")


class CopyDocument(BaseModel):
    """A part of a group of congruent parts."""

    part: int
    transform: list[_Vector] = Field(
        min_length=4,
        max_length=4,
        description="Rows of the 4 x 4 matrix that maps the first part of the group to this one, for column vectors "
        "(x, y, z, 1). It is rigid, with determinant -1 if it mirrors.",
    )
    mirrored: bool
    residual: float = Field(
        description="The largest deviation of points of either part from the other one, in units of the mesh."
    )
    mean_residual: float = Field(description="The root of the mean square of the deviations, in units of the mesh.")
    relative_residual: float = Field(description="The residual over the diagonal of the box of the first part.")
    related_color: str = Field(
        description="A lighter or darker shade of the colour of the first part, for an operation color."
    )


class RepeatDocument(BaseModel):
    copies: list[CopyDocument] = Field(
        min_length=2, description="In the order of their numbers; the first one is mapped to itself."
    )


class PartsDocument(BaseModel):
    unit: str | None = Field(description="The unit of length of the mesh; null if it is not known.")
    parts: list[ListedPart] = Field(description="In the order of their numbers.")
    repeats: list[RepeatDocument] = Field(description="Groups of congruent parts, such as the legs of a table.")
    repeats_complete: bool = Field(description="False if there were too many parts to compare all with each other.")


def parts_rendition(cache: ResultCache, cut: ChosenCut, tolerance: float) -> Rendition:
    """Return the list of the parts of a cut.

    Parameters
    ----------
    tolerance : largest deviation of congruent parts, in diagonals of the box of the first one.
    """

    def write(target: BinaryIO) -> None:
        mesh, partition = cut.result.mesh, cut.partition
        names, colors = ({}, {}) if partition is None else (partition.names, partition.colors)
        listed = segcore.parts(mesh, cut.labels, names, tolerance=tolerance)
        target.write(compact_json(part_list_document(listed, mesh.coordinates.unit, colors)))

    return cached_rendition(cache, cut, f"parts?{cut.name}&tolerance={tolerance!r}", "application/json", write)
