"""The query parameters of robots."""

from typing import Annotated

from fastapi import Depends, Query

from segcore.robots.options import (
    CONCAVITY,
    DENSITY,
    LARGEST_DENSITY,
    LARGEST_LENGTH,
    LARGEST_MOST_PIECES,
    LEAST_CONCAVITY,
    MOST_PIECES,
    Collision,
    Joints,
    RobotOptions,
)


async def _options(
    joints: Annotated[
        Joints,
        Query(
            description="All parts fixed to each other, or hinges at borders that are one plane loop and the only "
            "connection of two sides. The axis is the normal of the plane."
        ),
    ] = "fixed",
    collision: Annotated[
        Collision,
        Query(description="Convex pieces of each part by CoACD, which takes seconds for each, or its convex hull."),
    ] = "pieces",
    concavity: Annotated[
        float,
        Query(
            ge=LEAST_CONCAVITY,
            le=1,
            description="The largest concavity of a piece, as CoACD defines it: smaller values give more pieces.",
        ),
    ] = CONCAVITY,
    pieces: Annotated[
        int, Query(ge=1, le=LARGEST_MOST_PIECES, description="The largest number of convex pieces of a part.")
    ] = MOST_PIECES,
    density: Annotated[
        float, Query(gt=0, le=LARGEST_DENSITY, description="In kg/m^3; that of water by default.")
    ] = DENSITY,
    length: Annotated[
        float | None,
        Query(
            gt=0,
            le=LARGEST_LENGTH,
            description="The longest side of the whole in metres; by default that of the mesh. Lengths of a mesh whose "
            "unit is not known are taken as metres.",
        ),
    ] = None,
) -> RobotOptions:
    return RobotOptions(
        joints=joints, collision=collision, concavity=concavity, pieces=pieces, density=density, length=length
    )


RobotOptionsOf = Annotated[RobotOptions, Depends(_options)]
