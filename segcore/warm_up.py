"""Compiling or loading of the numba kernels before their first use."""

import numpy as np

from segcore.clean.surface import build_surface
from segcore.coarsen.grains import grown_grains, merged_grains
from segcore.io.limits import ReadLimits
from segcore.io.obj.reader import read_obj
from segcore.io.off.reader import read_off
from segcore.io.picture import draw
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters
from segcore.shapes import box, burr, icosphere, joined


def warm_up() -> None:
    """Compile the kernels, or load them from numba's cache, by segmenting, drawing and reading small meshes.

    A process that forks workers calls this first, so that its children start with the kernels in memory.
    """
    arms = burr(subdivisions=3).mesh
    draw(arms, segment(arms, SegmentationParameters(clusters=300)).labels(), size=16)  # fewer clusters than faces
    segment(_bodies())
    _begin_fine(arms)
    read_obj(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ReadLimits())
    read_off(b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", ReadLimits())


def _begin_fine(mesh: Mesh) -> None:
    """Carry out the steps that only fine meshes need."""
    graph = build_surface(mesh).face_graph()
    merged_grains(graph, grown_grains(graph))


def _bodies() -> Mesh:
    """A ball with a crack, and two boxes that touch, whose faces are so large that they are divided."""
    first, second = box(centre=(4.0, 0.0, 0.0)), box(centre=(5.001, 0.0, 0.0))
    return joined(_cracked(icosphere(2)), joined(first, second).mesh).mesh


def _cracked(mesh: Mesh) -> Mesh:
    """A mesh with a crack between one half of its faces and the other."""
    half = len(mesh.faces) // 2
    count = len(mesh.vertices)
    faces = np.concatenate([mesh.faces[:half], mesh.faces[half:] + count])
    return Mesh(np.concatenate([mesh.vertices, 1.0005 * mesh.vertices]), faces)
