"""Meshes of any size for measurements: a torus with waves."""

import io

import numpy as np

from segcore.io import write_mesh
from segcore.mesh import Mesh


def wavy_torus(faces: int, waves: int = 5) -> bytes:
    """Return a binary PLY file of a torus with waves, with about this number of faces."""
    columns = max(8, round(np.sqrt(faces)))
    rows = max(4, faces // (2 * columns))
    around, across = np.meshgrid(
        2 * np.pi * np.arange(columns) / columns, 2 * np.pi * np.arange(rows) / rows, indexing="ij"
    )
    tube = 0.35 + 0.12 * np.cos(waves * around)
    distance = 1 + tube * np.cos(across)
    vertices = np.stack([distance * np.cos(around), distance * np.sin(around), tube * np.sin(across)], axis=-1)
    index = np.arange(columns * rows, dtype=np.int32).reshape(columns, rows)
    right, up = np.roll(index, -1, axis=0), np.roll(index, -1, axis=1)
    corner = np.roll(right, -1, axis=1)
    corners = np.concatenate(
        [np.stack([index, right, corner], -1).reshape(-1, 3), np.stack([index, corner, up], -1).reshape(-1, 3)]
    )
    target = io.BytesIO()
    write_mesh(target, Mesh(vertices.reshape(-1, 3).astype(np.float32), corners), "ply")
    return target.getvalue()
