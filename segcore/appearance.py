"""Normals, texture coordinates, colours and named groups of a mesh file."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import IntArray
from segcore.errors import InvalidMesh


@dataclass(frozen=True, slots=True, eq=False)
class Appearance:
    """The attributes of a mesh besides its shape. The writers keep them; the segmentation does not use them.

    The arrays have a row for each of the V vertices of the mesh. A vertex with different values in different faces, as
    at a texture border or a hard edge, has further rows: row V + i belongs to vertex ``extra_vertex[i]``.

    Raises
    ------
    InvalidMesh
        If the shapes of the arrays do not match.
    """

    normals: NDArray[np.float32] | None = None  # (A, 3) unit vectors
    uvs: NDArray[np.float32] | None = None  # (A, 2) texture coordinates, (0, 0) is the upper left corner of the image
    colors: NDArray[np.uint8] | None = None  # (A, 4) sRGB and opacity, 0..255
    extra_vertex: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int32))  # (A - V,)
    corners: IntArray | None = None  # (F, 3) row of every corner; None if A = V: then it is the vertex
    face_group: IntArray | None = None  # (F,) index into ``group_names``
    group_names: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        rows = {len(values) for values in (self.normals, self.uvs, self.colors) if values is not None}
        widths = {"normals": 3, "uvs": 2, "colors": 4, "corners": 3}
        for name, width in widths.items():
            values = getattr(self, name)
            if values is not None and (values.ndim != 2 or values.shape[1] != width):
                raise InvalidMesh(f"The {name} of an appearance must have {width} columns, not shape {values.shape}.")
        if len(rows) > 1 or (len(self.extra_vertex) and self.corners is None):
            raise InvalidMesh("The arrays of an appearance do not have the same number of rows.")
        if self.face_group is not None and not _are_entries(self.face_group, len(self.group_names)):
            raise InvalidMesh("The groups of an appearance must be indices into its list of names.")

    @property
    def row_arrays(self) -> dict[str, NDArray[Any]]:
        """The arrays with a row for each vertex, by name; those that are None are left out."""
        arrays = {"normals": self.normals, "uvs": self.uvs, "colors": self.colors}
        return {name: values for name, values in arrays.items() if values is not None}

    def groups_of(self, faces: IntArray) -> list[str]:
        """The names of the groups of some faces, in the order of ``group_names``; empty if there are no groups."""
        if self.face_group is None:
            return []
        return [self.group_names[group] for group in np.unique(self.face_group[faces]).tolist()]

    def fits(self, vertex_count: int, face_count: int) -> bool:
        """Whether the arrays match a mesh of this size."""
        rows = vertex_count + len(self.extra_vertex)
        return (
            all(len(values) == rows for values in self.row_arrays.values())
            and _are_entries(self.extra_vertex, vertex_count)
            and (self.corners is None or (len(self.corners) == face_count and _are_entries(self.corners, rows)))
            and (self.face_group is None or self.face_group.shape == (face_count,))
        )


def group_appearance(names: Sequence[str], sizes: Sequence[int]) -> Appearance | None:
    """Groups of consecutive faces: run i has ``sizes[i]`` faces and ``names[i]``; None if no run has a name."""
    if not any(names):
        return None
    entry = {name: i for i, name in enumerate(dict.fromkeys(names))}
    groups = np.repeat(np.array([entry[name] for name in names], dtype=np.int32), sizes)
    return Appearance(face_group=groups, group_names=tuple(entry))


def unit_normals(values: NDArray[Any]) -> NDArray[np.float32] | None:
    """(A, 3) normals scaled to length 1; None if one of them has no direction."""
    lengths = np.linalg.norm(values.astype(np.float64), axis=1)
    if not (np.isfinite(lengths) & (lengths > np.finfo(np.float32).tiny)).all():
        return None
    return (values / lengths[:, None]).astype(np.float32)


def texture_coordinates(values: NDArray[Any]) -> NDArray[np.float32] | None:
    """(A, 2) texture coordinates as float32; None if one of them is not finite in that type."""
    uvs = values.astype(np.float32)
    return uvs if np.isfinite(uvs).all() else None


def color_bytes(values: NDArray[Any]) -> NDArray[np.uint8] | None:
    """(A, 4) colours from three or four columns of integers 0..255 or 0..65535, or of fractions 0..1; else None."""
    kind, top = values.dtype.kind, values.max(initial=0)
    if not 3 <= values.shape[1] <= 4 or not (values >= 0).all():
        return None
    if kind == "f" and top > 1 and (values != np.floor(values)).any():
        return None
    full = 1.0 if kind == "f" and top <= 1 else 255.0 if top <= 255 and values.dtype.itemsize != 2 else 65535.0
    if top > full:
        return None
    colors = np.full((len(values), 4), 255, dtype=np.uint8)
    colors[:, : values.shape[1]] = np.round(values * (255.0 / full))
    return colors


def appearance_or_none(appearance: Appearance) -> Appearance | None:
    """The appearance, or None if it is empty."""
    return appearance if appearance.row_arrays or appearance.face_group is not None else None


def _are_entries(values: IntArray, count: int) -> bool:
    return values.size == 0 or bool(values.min() >= 0 and values.max() < count)
