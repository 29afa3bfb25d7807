"""The PLY writer, binary: plain meshes, and segmented ones with colours and labels of faces and vertices."""

from collections.abc import Iterator, Sequence
from typing import Any, BinaryIO, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from segcore.appearance import Appearance
from segcore.arrays import IntArray
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io.converting import requested
from segcore.io.formats import PlyColors
from segcore.io.names import SegmentNames, segment_names
from segcore.io.palette import SegmentColors, color_bytes
from segcore.io.ply.divided import UNUSED, DividedVertices, divide
from segcore.mesh import Mesh

_ROWS = 2**16  # vertices or faces in a piece, about 1 MB
_NAMES = {"<f4": "float", "<f8": "double", "<i4": "int", "u1": "uchar"}
_APPEARANCE = {
    "normals": (("nx", "ny", "nz"), "<f4"),
    "uvs": (("s", "t"), "<f4"),
    "colors": (("red", "green", "blue", "alpha"), "u1"),
}
_COLOR = ("red", "green", "blue")


class _Column(NamedTuple):
    """One or more properties of an element, as a column of its table."""

    name: str
    dtype: str
    values: NDArray[Any]  # (N,) or (N, properties)


def encode_ply(mesh: Mesh) -> Iterator[bytes | memoryview]:
    """A binary little-endian PLY file of a mesh in pieces; the vertices are written as :func:`write_ply` does."""
    vertices = _vertex_columns(mesh)
    yield _header(vertices, len(mesh.faces))
    yield from _records(vertices)
    yield from _records(_corner_columns(mesh.faces))


def write_ply(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    colors: PlyColors = "vertices",
    names: SegmentNames | None = None,
    part_colors: SegmentColors | None = None,
    unit: str | None = None,
    up: str | None = None,
) -> None:
    """Write a binary little-endian PLY file with all faces in input order.

    A face has the properties ``vertex_indices``, ``red``, ``green``, ``blue`` and ``int label``. Coordinates are
    ``float`` if that is exact, else ``double``. A vertex keeps its normal and its texture coordinates (``s``, ``t``) if
    the input has one of each for every vertex.

    Parameters
    ----------
    colors : ``vertices``: vertices have the colour of their segment, too, which is what most programs show. Vertices
        between segments are divided: the vertices in input order are followed by copies, and each has an ``int label``
        (-1 if no face uses it) and an ``int source_vertex``, its index in the input. ``faces``: the vertices are those
        of the input, with their own colours.
    names : names of segments by label, for comments such as ``comment label 3 is wheel``.
    part_colors : colours of segments by label, in place of the fixed ones.
    unit, up : convert the coordinates to this unit, such as ``mm``, and to this axis up, ``y`` or ``z``; by default
        they are those of the mesh.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments, there are no such ``colors``, or the unit or the axis of the mesh is
        not known.
    """
    if colors not in get_args(PlyColors):
        raise InvalidParameters(f"Colours of PLY are those of {' or '.join(get_args(PlyColors))}, not {colors!r}.")
    mesh = requested(mesh, unit, up)
    labels = hierarchy.labels(segments)
    faces, vertices = mesh.faces, _vertex_columns(mesh)
    if colors == "vertices":
        divided = divide(mesh, labels)
        faces, vertices = divided.faces, _divided_columns(vertices, divided, part_colors)
    comments = [
        "comment written by Cleave: label is the segment of a face",
        *_name_comments(names, len(hierarchy.segment_nodes(segments))),
    ]
    properties = [*(f"property uchar {channel}" for channel in _COLOR), "property int label"]
    target.write(_header(vertices, len(faces), comments, properties))
    for piece in _records(vertices):
        target.write(piece)
    for piece in _records([*_corner_columns(faces), *_label_columns(labels, part_colors)]):
        target.write(piece)


def _divided_columns(columns: list[_Column], divided: DividedVertices, chosen: SegmentColors | None) -> list[_Column]:
    """The columns of the vertices, with the colours of their segments in place of their own."""
    palette = color_bytes(int(divided.label.max()) + 1, chosen)
    shown = np.where(divided.label[:, None] == UNUSED, np.uint8(255), palette[divided.label])
    kept = [column for column in columns if column.name not in _APPEARANCE["colors"][0]]
    return [
        *(_Column(column.name, column.dtype, column.values[divided.source]) for column in kept),
        *(_Column(channel, "u1", shown[:, i]) for i, channel in enumerate(_COLOR)),
        _Column("alpha", "u1", np.broadcast_to(np.uint8(255), len(shown))),
        _Column("label", "<i4", divided.label),
        _Column("source_vertex", "<i4", divided.source),
    ]


def _header(
    vertices: list[_Column], face_count: int, comments: Sequence[str] = (), face_properties: Sequence[str] = ()
) -> bytes:
    lines = [
        "ply",
        "format binary_little_endian 1.0",
        *comments,
        f"element vertex {len(vertices[0].values)}",
        *(f"property {_NAMES[column.dtype]} {column.name}" for column in vertices),
        f"element face {face_count}",
        "property list uchar int vertex_indices",
        *face_properties,
        "end_header\n",
    ]
    return "\n".join(lines).encode("ascii", "backslashreplace")


def _name_comments(names: SegmentNames | None, count: int) -> list[str]:
    called = segment_names(names, count)
    return [f"comment label {label} is {called[label]}" for label in sorted(names or {}) if 0 <= label < count]


def _vertex_columns(mesh: Mesh) -> list[_Column]:
    """A column for each property of a vertex."""
    with np.errstate(over="ignore"):
        is_single = bool((mesh.vertices == mesh.vertices.astype(np.float32)).all())
    columns = [_Column(axis, "<f4" if is_single else "<f8", mesh.vertices[:, i]) for i, axis in enumerate("xyz")]
    appearance = mesh.appearance or Appearance()
    if len(appearance.extra_vertex) == 0:
        for kind, values in appearance.row_arrays.items():
            names, dtype = _APPEARANCE[kind]
            if kind == "uvs":  # PLY counts from the lower left of the image
                values = values * np.array([1, -1], np.float32) + np.array([0, 1], np.float32)
            columns += [_Column(name, dtype, values[:, i]) for i, name in enumerate(names)]
    return columns


def _corner_columns(faces: IntArray) -> list[_Column]:
    sizes = np.broadcast_to(np.uint8(3), len(faces))
    return [_Column("size", "u1", sizes), _Column("corners", "<i4", faces)]


def _label_columns(labels: IntArray, chosen: SegmentColors | None) -> list[_Column]:
    colors = color_bytes(int(labels.max()) + 1, chosen)
    return [_Column("color", "u1", colors[labels]), _Column("label", "<i4", labels)]


def _records(columns: list[_Column]) -> Iterator[memoryview]:
    """The rows of an element as bytes, in pieces."""
    record = np.dtype([(column.name, column.dtype, column.values.shape[1:]) for column in columns])
    count = len(columns[0].values)
    for first in range(0, count, _ROWS):
        table = np.empty(min(_ROWS, count - first), record)
        for column in columns:
            table[column.name] = column.values[first : first + _ROWS]
        yield table.data.cast("B")
