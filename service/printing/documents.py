"""The report of a file for printing in the API."""

from pydantic import BaseModel, Field

from segcore.coordinates import Unit
from segcore.printing.options import Connectors


class ConnectorDocument(BaseModel):
    """A dowel or a peg; lengths in mm."""

    kind: Connectors
    diameter: float = Field(description="Of the dowel or the peg.", examples=[6.4])
    hole_diameter: float = Field(examples=[6.6])
    depth: float = Field(
        description="Of the dowel or the peg in each part with a hole, from the plane.", examples=[6.4]
    )
    hole_depth: float = Field(examples=[6.5])
    holes: int = Field(description="2 for a dowel, 1 for a peg.", examples=[2])
    centre: list[float] = Field(min_length=3, max_length=3, description="In the plane of the contact.")


class ContactDocument(BaseModel):
    """A place at which two parts touch, or two pieces of a part that was divided for the bed."""

    parts: list[int] = Field(min_length=2, max_length=2, examples=[[0, 3]])
    pieces: list[int] | None = Field(
        description="The numbers of two pieces of one part, as in their names; null between two parts."
    )
    area: float = Field(description="Of the region that the caps of both share, in mm^2.")
    circle_diameter: float = Field(description="Of the largest circle in that region; 0 if there is none.")
    deviation: float = Field(description="How far the border leaves the plane.")
    connector: ConnectorDocument | None
    reason: str | None = Field(description="Why there is no connector; null if there is one.")


class PrintedObject(BaseModel):
    """An object of the 3MF file: a part, a piece of one, or a dowel."""

    name: str
    part: int | None = Field(description="The part that it belongs to; null for a dowel.")
    slot: int = Field(description="The number of its filament.")
    closed: bool = Field(description="Whether it is a closed solid; one that is not has no connectors.")
    volume: float | None = Field(description="With pegs and without holes, in mm^3; null if it is not closed.")
    size: list[float] = Field(min_length=3, max_length=3)
    fits_bed: bool = Field(description="As it stands.")


class SlotDocument(BaseModel):
    """A filament."""

    slot: int = Field(ge=1)
    color: str = Field(examples=["#56b4e9"])
    parts: list[int]


class PrintDocument(BaseModel):
    """What a file for printing contains; lengths in mm."""

    unit_of_mesh: Unit | None = Field(description="null if it is not known: lengths are taken as mm.")
    scale: float = Field(description="The factor of all lengths in mm, for the requested size.")
    connectors: Connectors
    clearance: float
    bed: list[float] | None
    volume: float = Field(description="Of the closed parts before connectors are added, in mm^3.")
    objects: list[PrintedObject] = Field(description="In the order of the 3MF file.")
    slots: list[SlotDocument]
    contacts: list[ContactDocument]
