"""A triangle mesh as two arrays, checked when it is made."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from segcore.appearance import Appearance
from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.coordinates import UNKNOWN, Coordinates
from segcore.errors import InvalidMesh
from segcore.structure import FileStructure

_LARGEST_COORDINATE = 1e100  # areas and volumes of larger meshes leave the range of float64


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A triangle mesh; face i is the i-th triangle of the input.

    Parameters
    ----------
    vertices : (V, 3) coordinates; finite for the vertices that faces use. Other vertices count for nothing: they keep
        their place in the array, and those without a usable position get that of a vertex of the first face.
    faces : (F, 3) indices into ``vertices``, F >= 1. Repeated indices, duplicate faces, open borders,
        non-manifold edges and several components are allowed.
    source_polygon : (F,) the polygon of the file, counted from 0, that each face is a part of; None if every polygon is
        one face.
    appearance : normals, texture coordinates, colours and groups of the file; None if they were not read.
    structure : the group and the material of every face; None if the file has neither.
    notes : sentences on what the reader left out of the file or repaired.
    coordinates : the unit of length and the axis that points up, as far as they are known.

    Raises
    ------
    InvalidMesh
        If a shape, an index or a coordinate is wrong; the message names the first wrong one.
    """

    vertices: FloatArray  # (V, 3)
    faces: IntArray  # (F, 3)
    source_polygon: IntArray | None = None  # (F,)
    appearance: Appearance | None = None
    structure: FileStructure | None = None
    notes: tuple[str, ...] = ()
    coordinates: Coordinates = UNKNOWN

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        source_polygon: ArrayLike | None = None,
        appearance: Appearance | None = None,
        structure: FileStructure | None = None,
        notes: tuple[str, ...] = (),
        coordinates: Coordinates = UNKNOWN,
    ) -> None:
        points = _checked_vertices(vertices)
        object.__setattr__(self, "faces", _checked_faces(faces, len(points)))
        points, moved = _with_usable_positions(points, self.faces)
        object.__setattr__(self, "vertices", points)
        object.__setattr__(self, "source_polygon", _checked_polygons(source_polygon, len(self.faces)))
        object.__setattr__(self, "appearance", appearance)
        object.__setattr__(self, "structure", structure)
        object.__setattr__(self, "notes", (*notes, *moved))
        object.__setattr__(self, "coordinates", coordinates)
        if appearance is not None and not appearance.fits(len(self.vertices), len(self.faces)):
            raise InvalidMesh(
                "The arrays of the appearance do not match the numbers of vertices and faces of the mesh."
            )
        if structure is not None and not structure.fits(len(self.faces)):
            raise InvalidMesh("The groups and materials do not match the number of faces of the mesh.")

    @property
    def is_used(self) -> BoolArray:
        """(V,) True for the vertices that a face uses."""
        used = np.zeros(len(self.vertices), dtype=bool)
        used[self.faces] = True
        return used

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The lowest and the highest coordinates (3,) of the vertices that faces use."""
        points = self.vertices[self.is_used]
        return points.min(axis=0), points.max(axis=0)

    @property
    def corners(self) -> FloatArray:
        """(F, 3, 3) the positions of the three corners of every face."""
        corners: FloatArray = self.vertices[self.faces]
        return corners


def face_normals_and_areas(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Unit normals (F, 3) and areas (F,) of triangles with corners (F, 3, 3); a normal is zero if the area is zero."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    double_area = np.linalg.norm(cross, axis=1)
    normals = np.divide(cross, double_area[:, None], out=np.zeros_like(cross), where=double_area[:, None] > 0)
    return normals, 0.5 * double_area


def _checked_vertices(values: ArrayLike) -> FloatArray:
    vertices = _as_array(values, "vertices")
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise InvalidMesh(f"Vertices must be an array of shape (V, 3), not {vertices.shape}.")
    if vertices.dtype.kind not in "fiu":
        raise InvalidMesh(f"Vertices must be real numbers, not {vertices.dtype}.")
    return np.ascontiguousarray(vertices, dtype=np.float64)


def _with_usable_positions(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, tuple[str, ...]]:
    """The vertices, those without a usable position moved to a vertex of the first face, and a note if there are some.

    Raises InvalidMesh if a face uses such a vertex.
    """
    if -_LARGEST_COORDINATE <= vertices.min() <= vertices.max() <= _LARGEST_COORDINATE:  # false if there is a NaN
        return vertices, ()
    is_usable = np.abs(vertices).max(axis=1) <= _LARGEST_COORDINATE
    wrong = faces[~is_usable[faces]]
    if len(wrong):
        first = int(wrong.min())
        if np.isfinite(vertices[first]).all():
            raise InvalidMesh(
                f"Vertex {first} has a coordinate larger than {_LARGEST_COORDINATE:g}: use a larger unit of length."
            )
        raise InvalidMesh(f"Vertex {first} has a coordinate that is not finite: repair the mesh before sending it.")
    target = int(faces[0, 0])
    moved = np.where(is_usable[:, None], vertices, vertices[target])
    count = int((~is_usable).sum())
    if count == 1:
        return moved, (f"A vertex that no face uses is not finite or too far away: it was moved to vertex {target}.",)
    return moved, (
        f"{count} vertices that no face uses are not finite or too far away: they were moved to vertex {target}.",
    )


def _checked_faces(values: ArrayLike, vertex_count: int) -> IntArray:
    faces = _as_array(values, "faces")
    if faces.ndim != 2 or faces.shape[1] != 3:
        raise InvalidMesh(f"Faces must be an array of shape (F, 3), not {faces.shape}: triangulate polygons first.")
    if len(faces) == 0:
        raise InvalidMesh("The mesh has no faces: a point cloud or an empty file cannot be segmented.")
    if faces.dtype.kind not in "iu":
        raise InvalidMesh(f"Faces must be integers, not {faces.dtype}.")
    if not 0 <= faces.min() <= faces.max() < vertex_count:
        first = int(np.argmax(((faces < 0) | (faces >= vertex_count)).any(axis=1)))
        raise InvalidMesh(f"Face {first} refers to a vertex outside 0..{vertex_count - 1}: {faces[first].tolist()}.")
    return np.ascontiguousarray(faces, dtype=np.int32)


def _checked_polygons(values: ArrayLike | None, face_count: int) -> IntArray | None:
    if values is None:
        return None
    polygons = _as_array(values, "source polygons")
    if polygons.shape != (face_count,) or polygons.dtype.kind not in "iu":
        raise InvalidMesh(f"There must be one integer source polygon for each of the {face_count} faces.")
    return np.ascontiguousarray(polygons, dtype=np.int32)


def _as_array(values: ArrayLike, name: str) -> np.ndarray[Any, np.dtype[Any]]:
    try:
        return np.asarray(values)
    except ValueError as error:
        raise InvalidMesh(f"The {name} do not form a rectangular array.") from error
