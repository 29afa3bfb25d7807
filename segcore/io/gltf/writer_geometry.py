"""The positions of a GLB file in float32."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import transformed
from segcore.mesh import Mesh

_FAR_OUT = 16.0  # distance from the origin, in extents of the mesh, at which float32 coordinates lose 4 of 24 bits
# Viewers square lengths in float32, whose normal numbers are 1e-38 to 3e38: here also those of edges that are 10,000
# times shorter than the extent.
_PLAIN_EXTENT = (1e-15, 1e15)
_Z_UP_TO_Y_UP = [-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]  # a quarter of a turn about x


@dataclass(frozen=True, slots=True, eq=False)
class Placement:
    """Positions, and the transform of the root node.

    For each vertex i that a face uses, translation + rotation (scale * positions[i]) is vertices[i] in the coordinates
    of glTF, in metres with y up, as far as the unit and the axis of the mesh are known.
    """

    positions: NDArray[np.float32]  # (A, 3) those of the vertices, then of the further rows of the appearance
    translation: list[float]
    rotation: list[float] | None  # a quaternion in the order x, y, z, w; None for no rotation
    scale: float

    @property
    def members(self) -> dict[str, list[float]]:
        """The members of a glTF node with this transform, without those that are not needed."""
        members = {"translation": self.translation} if any(self.translation) else {}
        if self.rotation is not None:
            members["rotation"] = self.rotation
        return members | ({"scale": [self.scale] * 3} if self.scale != 1.0 else {})


def place(mesh: Mesh) -> Placement:
    """Return the positions, moved to the centre and scaled only if they would be rounded visibly otherwise.

    A unit or an axis other than those of glTF changes the transform alone.
    """
    low, high = mesh.bounds
    extent = float((high - low).max())
    centre = 0.5 * low + 0.5 * high
    scale = 1.0 if extent == 0 or _PLAIN_EXTENT[0] <= extent <= _PLAIN_EXTENT[1] else extent
    if scale == 1.0 and np.abs([low, high]).max() <= _FAR_OUT * extent:
        positions, translation = mesh.vertices, np.zeros(3)
    else:
        positions, translation = (np.clip(mesh.vertices, low, high) - centre) / scale, centre
    inside = np.where(mesh.is_used[:, None], positions, (centre - translation) / scale)
    rows = inside.astype("<f4")
    if mesh.appearance is not None and len(mesh.appearance.extra_vertex):
        rows = np.concatenate([rows, rows[mesh.appearance.extra_vertex]])
    meters, turn = mesh.coordinates.scale_to("meter"), mesh.coordinates.rotation_to("y")
    is_turned = bool((turn != np.eye(3)).any())
    return Placement(
        rows,
        (transformed(translation, turn) * meters).tolist(),
        _Z_UP_TO_Y_UP if is_turned else None,
        scale * meters,
    )
