"""The report of a robot in the API."""

from pydantic import BaseModel, Field

from segcore.coordinates import Unit
from segcore.robots.options import Collision, Joints

_Vector = list[float]


class LinkDocument(BaseModel):
    """A part as a link."""

    link: str = Field(description="The name of the link in the files.", examples=["left_arm"])
    part: int = Field(description="Its label.")
    name: str = Field(description="The name of the part.", examples=["left arm"])
    parent: str | None = Field(description="The link that it is joined to; null for the root.")
    joint: Joints | None = Field(description="null for the root.")
    origin: _Vector = Field(
        min_length=3, max_length=3, description="Of its coordinates; a point on the axis of a hinge."
    )
    axis: _Vector | None = Field(min_length=3, max_length=3, description="Of a hinge, a unit vector.")
    why_fixed: str | None = Field(description="Why a joint is fixed, if hinges were requested.")
    mass: float | None = Field(description="null if the part is flat.")
    volume: float | None = Field(description="That belongs to the mass.")
    centre_of_mass: _Vector | None = Field(min_length=3, max_length=3)
    closed: bool = Field(description="Whether the mass is that of the part closed by caps.")
    collision_pieces: int = Field(description="Number of convex pieces.")
    note: str | None = Field(description="A sentence, if that is not so.")


class RobotDocument(BaseModel):
    """What a robot consists of; in metres and kilograms, with z up, the origin on the ground below the middle."""

    unit_of_mesh: Unit | None = Field(description="null if it is not known: lengths are taken as metres.")
    scale: float = Field(description="The factor of all lengths in metres, for the requested length.")
    density: float
    joints: Joints
    collision: Collision
    mass: float
    volume: float
    links: list[LinkDocument] = Field(description="The root first, each after its parent.")
