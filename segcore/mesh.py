"""A triangle mesh as two arrays, checked when it is made."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from segcore.appearance import Appearance
from segcore.arrays import FloatArray, IntArray
from segcore.errors import InvalidMesh
from segcore.structure import FileStructure

_LARGEST_COORDINATE = 1e100  # areas and volumes of larger meshes leave the range of float64


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A triangle mesh; face i is the i-th triangle of the input.

    Parameters
    ----------
    vertices : (V, 3) finite coordinates, any unit.
    faces : (F, 3) indices into ``vertices``, F >= 1. Repeated indices, duplicate faces, open borders,
        non-manifold edges and several components are allowed.
    source_polygon : (F,) the polygon of the file, counted from 0, that each face is a part of; None if every polygon is
        one face.
    appearance : normals, texture coordinates, colours and groups of the file; None if they were not read.
    structure : the group and the material of every face; None if the file has neither.
    notes : sentences on what the reader left out of the file or repaired.

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

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        source_polygon: ArrayLike | None = None,
        appearance: Appearance | None = None,
        structure: FileStructure | None = None,
        notes: tuple[str, ...] = (),
    ) -> None:
        object.__setattr__(self, "vertices", _checked_vertices(vertices))
        object.__setattr__(self, "faces", _checked_faces(faces, len(self.vertices)))
        object.__setattr__(self, "source_polygon", _checked_polygons(source_polygon, len(self.faces)))
        object.__setattr__(self, "appearance", appearance)
        object.__setattr__(self, "structure", structure)
        object.__setattr__(self, "notes", notes)
        if appearance is not None and not appearance.fits(len(self.vertices), len(self.faces)):
            raise InvalidMesh(
                "The arrays of the appearance do not match the numbers of vertices and faces of the mesh."
            )
        if structure is not None and not structure.fits(len(self.faces)):
            raise InvalidMesh("The groups and materials do not match the number of faces of the mesh.")

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


def face_centroids(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """(F, 3) the mean of the three corners of every face."""
    a, b, c = faces.T
    centroids: FloatArray = (vertices[a] + vertices[b] + vertices[c]) / 3.0
    return centroids


def _checked_vertices(values: ArrayLike) -> FloatArray:
    vertices = _as_array(values, "vertices")
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise InvalidMesh(f"Vertices must be an array of shape (V, 3), not {vertices.shape}.")
    if vertices.dtype.kind not in "fiu":
        raise InvalidMesh(f"Vertices must be real numbers, not {vertices.dtype}.")
    vertices = np.ascontiguousarray(vertices, dtype=np.float64)
    if len(vertices) == 0:
        return vertices
    low, high = float(vertices.min()), float(vertices.max())  # NaN if any coordinate is NaN
    if not (np.isfinite(low) and np.isfinite(high)):
        first = int(np.argmin(np.isfinite(vertices).all(axis=1)))
        raise InvalidMesh(f"Vertex {first} has a coordinate that is not finite: repair the mesh before sending it.")
    if max(-low, high) > _LARGEST_COORDINATE:
        raise InvalidMesh(f"A coordinate is larger than {_LARGEST_COORDINATE:g}: use a larger unit of length.")
    return vertices


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
