"""Mesh files for the browser tests."""

import io

import numpy as np

from segcore.mesh import Mesh
from segcore.shapes import burr


def small_burr() -> bytes:
    """Return a ball with six arms and 5120 faces as a PLY file."""
    return ply(burr(4).mesh)


def ply(mesh: Mesh) -> bytes:
    text = io.StringIO()
    text.write(f"ply\nformat ascii 1.0\nelement vertex {len(mesh.vertices)}\n")
    text.write("property float x\nproperty float y\nproperty float z\n")
    text.write(f"element face {len(mesh.faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    np.savetxt(text, mesh.vertices, fmt="%.6f")
    np.savetxt(text, np.insert(mesh.faces, 0, 3, axis=1), fmt="%d")
    return text.getvalue().encode()
