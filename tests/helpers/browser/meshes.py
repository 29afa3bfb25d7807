"""Mesh files for the browser tests."""

from helpers.files.written import mesh_bytes
from segcore.shapes import burr


def small_burr() -> bytes:
    """Return a ball with six arms and 5120 faces as a PLY file."""
    return mesh_bytes(burr(4).mesh, "ply")
