"""Meshes of any size for measurements: a torus with waves."""

import io

import numpy as np


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
    records = np.empty(len(corners), dtype=np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
    records["count"], records["corners"] = 3, corners
    target = io.BytesIO()
    head = [
        "ply",
        "format binary_little_endian 1.0",
        f"element vertex {vertices.size // 3}",
        *(f"property float {axis}" for axis in "xyz"),
        f"element face {len(corners)}",
        "property list uchar int vertex_indices",
        "end_header\n",
    ]
    target.write("\n".join(head).encode())
    target.write(vertices.reshape(-1, 3).astype("<f4").tobytes())
    target.write(records.tobytes())
    return target.getvalue()
