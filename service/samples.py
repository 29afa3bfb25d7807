"""Sample meshes of the page, made with :mod:`segcore.shapes`."""

import io
from collections.abc import Callable

import numpy as np

from segcore.mesh import Mesh
from segcore.shapes import Shape, burr, dumbbell, joined, revolve

_AROUND = 64  # vertices of a ring
_PAWN = (  # (height, radius) of the corners of its outline, by part, from the foot up
    [(0.0, 1.0), (0.35, 1.0), (0.55, 0.72), (0.75, 0.6)],
    [(1.1, 0.42), (1.7, 0.3)],
    [(1.78, 0.56), (1.95, 0.56)],
    [(2.02, 0.32), *((2.55 + 0.6 * np.sin(t), 0.6 * np.cos(t)) for t in np.linspace(-0.85, 1.5, 16))],
)


def sample_ply(name: str) -> bytes:
    """Return a sample as binary PLY; errors as in :func:`sample_shape`."""
    from segcore.io import write_mesh

    mesh = sample_shape(name).mesh
    target = io.BytesIO()
    write_mesh(target, Mesh(mesh.vertices.astype(np.float32), mesh.faces), "ply")
    return target.getvalue()


def sample_shape(name: str) -> Shape:
    """Return a sample with the y axis up.

    Raises
    ------
    KeyError
        If there is no sample with this name.
    """
    shape = _SHAPES[name]()
    x, y, z = shape.mesh.vertices.T
    return Shape(Mesh(np.stack([y, z, x], axis=1), shape.mesh.faces), shape.parts)


def _pawn() -> Shape:
    corners = np.array([corner for part in _PAWN for corner in part])
    part_of_corner = np.repeat(np.arange(len(_PAWN)), [len(part) for part in _PAWN])
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    steps = np.linspace(0, along[-1], 90)
    mesh = revolve(np.interp(steps, along, corners[:, 1]), np.interp(steps, along, corners[:, 0]), _AROUND)
    middle = mesh.corners[:, :, 2].mean(axis=1)
    parts = part_of_corner[np.searchsorted(corners[1:-1, 0], middle)]
    return Shape(mesh, parts.astype(np.int32))


def _stool() -> Shape:
    """Return a seat with four legs that intersect it: five components."""
    height = np.linspace(0, 1, 24)
    rim = np.sqrt(np.maximum(0.02, 1 - (2 * height - 1) ** 6))
    seat = _moved(revolve(1.0 * rim, 0.3 * height, _AROUND), (0.0, 0.0, 1.6))
    legs = [
        _moved(revolve(np.linspace(0.11, 0.17, 24), 1.7 * height, _AROUND // 2), (x, y, 0.0))
        for x in (-0.6, 0.6)
        for y in (-0.6, 0.6)
    ]
    return joined(seat, *legs)


def _moved(mesh: Mesh, by: tuple[float, float, float]) -> Mesh:
    return Mesh(mesh.vertices + np.array(by), mesh.faces)


_SHAPES: dict[str, Callable[[], Shape]] = {"jack": burr, "pawn": _pawn, "dumbbell": dumbbell, "stool": _stool}
SAMPLES = tuple(_SHAPES)
