"""The PLY writer: a colour and a label on every face."""

from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from segcore.appearance import Appearance
from segcore.hierarchy import Hierarchy
from segcore.io.names import SegmentNames, segment_names
from segcore.io.palette import color_bytes
from segcore.mesh import Mesh

_ROWS = 2**16  # that are put together at a time
_NAMES = {"<f4": "float", "<f8": "double", "<i4": "int", "u1": "uchar"}
_APPEARANCE = {
    "normals": (("nx", "ny", "nz"), "<f4"),
    "uvs": (("s", "t"), "<f4"),
    "colors": (("red", "green", "blue", "alpha"), "u1"),
}
_FACE = np.dtype([("size", "u1"), ("corners", "<i4", 3), ("color", "u1", 3), ("label", "<i4")])


def write_ply(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    names: SegmentNames | None = None,
) -> None:
    """Write a binary little-endian PLY file: all vertices and all faces in input order.

    A face has the properties ``vertex_indices``, ``red``, ``green``, ``blue`` and ``int label``. Coordinates are
    ``float`` where that holds them exactly, else ``double``. A vertex keeps its normal, its texture coordinates
    (``s``, ``t``) and its colour where the input had them and had one of each for every vertex.

    Parameters
    ----------
    names : what segments are called, for comments such as ``comment label 3 is wheel``.

    Raises
    ------
    InvalidParameters
        Where ``segments`` is not in 1..max_segments.
    """
    labels = hierarchy.labels(segments)
    columns = _vertex_columns(mesh)
    header = [
        "ply",
        "format binary_little_endian 1.0",
        "comment written by Cleave: label is the segment of a face",
        *_name_comments(names, len(hierarchy.segment_nodes(segments))),
        f"element vertex {len(mesh.vertices)}",
        *(f"property {_NAMES[dtype]} {name}" for name, dtype, _ in columns),
        f"element face {len(mesh.faces)}",
        "property list uchar int vertex_indices",
        *(f"property uchar {channel}" for channel in ("red", "green", "blue")),
        "property int label",
        "end_header\n",
    ]
    target.write("\n".join(header).encode("ascii", "backslashreplace"))
    _write_vertices(target, columns, len(mesh.vertices))
    _write_faces(target, mesh, labels)


def _name_comments(names: SegmentNames | None, count: int) -> list[str]:
    called = segment_names(names, count)
    return [f"comment label {label} is {called[label]}" for label in sorted(names or {}) if 0 <= label < count]


def _vertex_columns(mesh: Mesh) -> list[tuple[str, str, NDArray[Any]]]:
    """Name, type and values of every property of a vertex."""
    with np.errstate(over="ignore"):
        is_single = bool((mesh.vertices == mesh.vertices.astype(np.float32)).all())
    columns = [(axis, "<f4" if is_single else "<f8", mesh.vertices[:, i]) for i, axis in enumerate("xyz")]
    appearance = mesh.appearance or Appearance()
    if len(appearance.extra_vertex) == 0:
        for kind, values in appearance.row_arrays.items():
            names, dtype = _APPEARANCE[kind]
            if kind == "uvs":  # PLY counts from the lower left of the image
                values = values * np.array([1, -1], np.float32) + np.array([0, 1], np.float32)
            columns += [(name, dtype, values[:, i]) for i, name in enumerate(names)]
    return columns


def _write_vertices(target: BinaryIO, columns: list[tuple[str, str, NDArray[Any]]], count: int) -> None:
    rows = np.dtype([(name, dtype) for name, dtype, _ in columns])
    for first in range(0, count, _ROWS):
        table = np.empty(min(_ROWS, count - first), rows)
        for name, _, values in columns:
            table[name] = values[first : first + _ROWS]
        target.write(table.data.cast("B"))


def _write_faces(target: BinaryIO, mesh: Mesh, labels: NDArray[np.int32]) -> None:
    colors = color_bytes(int(labels.max()) + 1)
    for first in range(0, len(labels), _ROWS):
        of_rows = labels[first : first + _ROWS]
        table = np.empty(len(of_rows), _FACE)
        table["size"] = 3
        table["corners"] = mesh.faces[first : first + _ROWS]
        table["color"] = colors[of_rows]
        table["label"] = of_rows
        target.write(table.data.cast("B"))
