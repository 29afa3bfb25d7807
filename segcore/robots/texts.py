"""Numbers, names of files, and which links are drawn, in URDF and MJCF."""

from collections.abc import Iterable

from segcore.robots.plan import Link

_LEAST_VERTICES = 4  # of a mesh, as MuJoCo wants them


def numbers(values: Iterable[float]) -> str:
    """Return numbers with a space between them, which read back as the same ones."""
    return " ".join(repr(float(value) + 0.0) for value in values)  # no -0.0


def is_drawn(link: Link) -> bool:
    """Return whether the part of a link is a mesh that every simulator takes."""
    return len(link.body.shape.vertices) >= _LEAST_VERTICES


def mesh_file(link: Link) -> str:
    """Return the file of the part of a link."""
    return f"meshes/{link.name}.obj"


def collision_file(link: Link, piece: int) -> str:
    """Return the file of a convex piece of a link."""
    return f"collision/{link.name}_{piece}.obj"
