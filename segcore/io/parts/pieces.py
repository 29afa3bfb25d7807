"""The segments of a mesh as separate meshes, as they are or closed for printing."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.clean.surface import Surface, build_surface
from segcore.hierarchy import Hierarchy
from segcore.io.parts.caps import close_borders
from segcore.io.parts.inside import InsideTest
from segcore.io.parts.joints import Inside
from segcore.io.parts.solids import divided_vertices, is_manifold, outward
from segcore.io.slices import Slices, group, segment_slices
from segcore.mesh import Mesh

_ROUNDING = 1e-12  # of the largest coordinate: what scaling to the extent 1 and back may change, with some margin


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A segment as a mesh."""

    label: int
    vertices: FloatArray  # (V, 3) the vertices that its faces use, in input order
    faces: IntArray  # (F, 3)
    is_solid: bool | None = None  # of closed parts: each edge has two faces, which are oriented consistently


def parts_of(
    mesh: Mesh, hierarchy: Hierarchy, segments: int | None, closed: bool, offset: FloatArray
) -> Iterator[Part]:
    """Yield each segment, closed or as it is, with ``offset`` (3,) subtracted from its vertices.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments.
    """
    for part in (closed_parts if closed else segment_parts)(mesh, hierarchy, segments):
        yield replace(part, vertices=part.vertices - offset) if offset.any() else part


def segment_parts(mesh: Mesh, hierarchy: Hierarchy, segments: int | None = None) -> Iterator[Part]:
    """Yield each segment with its input faces in input order, degenerate ones too.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments.
    """
    yield from open_groups(mesh, segment_slices(hierarchy, segments))


def open_groups(mesh: Mesh, slices: Slices) -> Iterator[Part]:
    """Yield each group of input faces, in input order, degenerate ones too."""
    yield from _parts(mesh.vertices, mesh.faces, slices)


def closed_parts(mesh: Mesh, hierarchy: Hierarchy, segments: int | None = None) -> Iterator[Part]:
    """Yield each segment closed by caps, at its cuts and at the holes of the input.

    Vertices at the same position are welded, faces are oriented consistently, and degenerate and repeated faces are
    removed. The border of the result is empty. A segment without remaining faces is left out.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments.
    """
    labels, count = hierarchy.labels(segments), len(hierarchy.segment_nodes(segments))
    surface = build_surface(mesh)
    yield from closed_groups(positions(mesh, surface), surface.faces, labels_on(surface, labels), count)


def closed_groups(vertices: FloatArray, faces: IntArray, labels: IntArray, count: int) -> Iterator[Part]:
    """Yield the faces of every label 0..count - 1 closed by caps, as :func:`closed_parts` does for segments.

    Parameters
    ----------
    vertices, faces : those of a surface; the vertices at their positions in the file.
    labels : (F,) of the faces of the surface.
    """
    is_inside = InsideTest(vertices, faces)
    a, b, c = faces.T
    distinct = (a != b) & (b != c) & (c != a)  # all, unless all faces of the mesh are degenerate
    for part in _parts(vertices, faces[distinct], group(labels[distinct], count)):
        yield _solid(part, is_inside)


def labels_on(surface: Surface, labels: IntArray) -> IntArray:
    """(F,) the labels of the faces of a surface: that of the first input face that each represents."""
    label_of_face = np.zeros(len(surface.faces), dtype=np.int32)
    label_of_face[surface.face_of_input[::-1]] = labels[::-1]
    return label_of_face


def _solid(part: Part, is_inside: Inside) -> Part:
    closed = close_borders(part.vertices, part.faces, is_inside)
    is_cap = np.arange(len(closed.faces)) >= len(part.faces)
    vertices, faces = divided_vertices(closed.vertices, closed.faces)
    return Part(part.label, vertices, outward(vertices, faces, is_cap), is_manifold(faces))


def positions(mesh: Mesh, surface: Surface) -> FloatArray:
    """(V, 3) the positions of the vertices of the surface in the file, without rounding errors."""
    low, high = mesh.bounds
    positions = surface.vertices * surface.unit + (0.5 * low + 0.5 * high)  # the surface is centred on the box
    kept, first = np.unique(surface.face_of_input, return_index=True)
    corners, given = surface.faces[kept], mesh.faces[first]
    given = np.where(surface.is_flipped[kept, None], given[:, [0, 2, 1]], given)
    near = np.abs(mesh.vertices[given] - positions[corners]) <= _ROUNDING * np.abs([low, high]).max()
    is_same = near[:, :, 0] & near[:, :, 1] & near[:, :, 2]
    positions[corners[is_same]] = mesh.vertices[given[is_same]]
    return positions


def _parts(vertices: FloatArray, faces: IntArray, slices: Slices) -> Iterator[Part]:
    place = np.empty(len(vertices), dtype=np.int32)
    for label in range(len(slices)):
        corners = faces[slices[label]]
        used = np.unique(corners)
        place[used] = np.arange(len(used))
        if len(corners):
            yield Part(label, vertices[used], place[corners])
