"""The OFF writer."""

from collections.abc import Iterator

from segcore.io.text.rows import format_rows
from segcore.mesh import Mesh


def encode_off(mesh: Mesh) -> Iterator[bytes]:
    """An OFF file in pieces; its numbers read back as the same float64 numbers."""
    yield f"OFF\n{len(mesh.vertices)} {len(mesh.faces)} 0\n".encode("ascii")
    yield from format_rows("%r %r %r\n", mesh.vertices)
    yield from format_rows("3 %d %d %d\n", mesh.faces)
