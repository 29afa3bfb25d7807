"""The positions of a GLB file in float32."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from segcore.mesh import Mesh

_FAR_OUT = 16.0  # distance from the origin, in extents of the mesh, at which float32 coordinates lose 4 of 24 bits
# Viewers square lengths in float32, whose normal numbers are 1e-38 to 3e38: here also those of edges that are 10,000
# times shorter than the extent.
_PLAIN_EXTENT = (1e-15, 1e15)


@dataclass(frozen=True, slots=True, eq=False)
class Placement:
    """Positions with vertices[i] = translation + scale * positions[i] for each vertex i that a face uses."""

    positions: NDArray[np.float32]  # (A, 3) those of the vertices, then of the further rows of the appearance
    translation: list[float]
    scale: float


def place(mesh: Mesh) -> Placement:
    """Return the positions, moved to the centre and scaled only if they would be rounded visibly otherwise."""
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
    return Placement(rows, translation.tolist(), scale)
