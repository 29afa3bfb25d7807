"""Compiling or loading of the numba kernels before their first use."""

import io
from collections.abc import Callable
from typing import get_args

import numpy as np

from segcore.clean.surface import build_surface
from segcore.coarsen.grains import grown_grains, merged_grains
from segcore.edit.guide import Guide
from segcore.io.limits import ReadLimits
from segcore.io.obj.reader import read_obj
from segcore.io.off.reader import read_off
from segcore.io.picture import draw
from segcore.io.reading import read_mesh
from segcore.io.result import write_result
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters, Solver
from segcore.report import mesh_report
from segcore.shapes import box, burr, icosphere, joined

_OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
_OFF = b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
_STL = b"solid a\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n"


def warm_up(*groups: str) -> None:
    """Compile the kernels, or load them from numba's cache, by segmenting, drawing, editing and reading small meshes.

    A process that forks workers calls this first, so that its children start with the kernels in memory.

    Parameters
    ----------
    groups : names of ``segcore.kernels.GROUPS``, all by default.
    """
    for group in groups or _TASKS:
        _TASKS[group]()


def _segment() -> None:
    """Do in memory what every job does."""
    mesh = burr(subdivisions=3).mesh
    surface = build_surface(mesh)
    hierarchy = segment(mesh, SegmentationParameters(clusters=300), surface=surface)  # fewer clusters than faces
    write_result(io.BytesIO(), mesh, hierarchy)
    mesh_report(mesh, surface)


def _read() -> None:
    read_obj(_OBJ, ReadLimits())
    read_off(_OFF, ReadLimits())
    read_mesh(io.BytesIO(_STL), "stl")


def _bodies() -> None:
    """Segment a ball with a crack, and two boxes that touch, whose faces are so large that they are divided."""
    first, second = box(centre=(4.0, 0.0, 0.0)), box(centre=(5.001, 0.0, 0.0))
    segment(joined(_cracked(icosphere(2)), joined(first, second).mesh).mesh)


def _cracked(mesh: Mesh) -> Mesh:
    """A mesh with a crack between one half of its faces and the other."""
    half = len(mesh.faces) // 2
    count = len(mesh.vertices)
    faces = np.concatenate([mesh.faces[:half], mesh.faces[half:] + count])
    return Mesh(np.concatenate([mesh.vertices, 1.0005 * mesh.vertices]), faces)


def _fine() -> None:
    """Carry out the steps that only fine meshes need."""
    graph = build_surface(burr(subdivisions=3).mesh).face_graph()
    merged_grains(graph, grown_grains(graph))


def _draw() -> None:
    mesh = icosphere(2)
    draw(mesh, np.arange(len(mesh.faces), dtype=np.int32) // 160, size=16)


def _edit() -> None:
    """Mark, divide and smooth parts of a ball with arms."""
    shape = burr(subdivisions=3)
    guide = Guide(shape.mesh, segment(shape.mesh))
    ball, arm = (np.flatnonzero(shape.parts == part) for part in (0, 1))
    guide.part(arm[:1], ball[:1])
    guide.border(shape.parts, 0, 1)
    guide.border(shape.parts, 0, 1, arm[:2])
    height = shape.mesh.corners.mean(axis=1)[:, 2]
    across = np.flatnonzero(np.abs(height) < 0.2)
    guide.cut(np.zeros_like(shape.parts), 0, across[np.argsort(shape.mesh.corners.mean(axis=1)[across, 0])][[0, -1]])
    guide.smooth(shape.parts)


def _solvers() -> None:
    """Segment a small mesh with every solver."""
    for solver in get_args(Solver):
        segment(burr(subdivisions=2).mesh, SegmentationParameters(solver=solver, clusters=100, max_segments=3))


_TASKS: dict[str, Callable[[], None]] = {
    "segment": _segment,
    "read": _read,
    "bodies": _bodies,
    "fine": _fine,
    "draw": _draw,
    "edit": _edit,
    "solvers": _solvers,
}
