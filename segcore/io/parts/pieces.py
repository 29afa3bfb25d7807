"""The segments of a mesh as separate meshes, as they are or closed for printing."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.clean.surface import build_surface
from segcore.hierarchy import Hierarchy
from segcore.io.parts.caps import close_borders
from segcore.io.slices import Slices, group, segment_slices
from segcore.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A segment as a mesh."""

    label: int
    vertices: FloatArray  # (V, 3) the vertices that its faces use, in input order
    faces: IntArray  # (F, 3)


def segment_parts(mesh: Mesh, hierarchy: Hierarchy, segments: int | None = None) -> Iterator[Part]:
    """Yield each segment with its input faces in input order, degenerate ones too.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments.
    """
    yield from _parts(mesh.vertices, mesh.faces, segment_slices(hierarchy, segments))


def closed_parts(mesh: Mesh, hierarchy: Hierarchy, segments: int | None = None) -> Iterator[Part]:
    """Yield each segment closed by caps, at its cuts and at the holes of the input.

    Vertices at the same position are welded, faces are oriented consistently, and degenerate and repeated faces are
    removed. The border of the result is empty. A segment without remaining faces is left out.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments.
    """
    labels = hierarchy.labels(segments)
    count = len(hierarchy.segment_nodes(segments))
    surface = build_surface(mesh)
    low, high = mesh.bounds
    vertices = surface.vertices * surface.unit + (0.5 * low + 0.5 * high)  # the surface is centred on the box
    label_of_face = np.zeros(len(surface.faces), dtype=np.int32)
    label_of_face[surface.face_of_input[::-1]] = labels[::-1]  # if they differ, that of the first input face
    for part in _parts(vertices, surface.faces, group(label_of_face, count)):
        closed = close_borders(part.vertices, part.faces)
        yield Part(part.label, closed.vertices, closed.faces)


def _parts(vertices: FloatArray, faces: IntArray, slices: Slices) -> Iterator[Part]:
    place = np.empty(len(vertices), dtype=np.int32)
    for label in range(len(slices)):
        corners = faces[slices[label]]
        used = np.unique(corners)
        place[used] = np.arange(len(used))
        if len(corners):
            yield Part(label, vertices[used], place[corners])
