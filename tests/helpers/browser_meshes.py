"""Mesh files for the tests of the viewer."""

from helpers.files.written import mesh_bytes
from segcore.shapes import burr


def small_burr() -> bytes:
    """A ball with six arms, 5120 faces, as PLY."""
    return mesh_bytes(burr(4).mesh, "ply")
