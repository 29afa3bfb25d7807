"""Polygons that are put together from their triangles are those of the file."""

import io

import numpy as np
import pytest

from segcore.io import read_mesh
from segcore.io.usd.polygons import corner_loops
from segcore.mesh import Mesh

# A quadrilateral, a triangle, a star with five points that is no fan, and a quadrilateral that is one.
POLYGONS = [[0, 1, 2, 3], [1, 4, 2], [5, 6, 7, 8, 9, 10, 11, 12, 13, 14], [3, 2, 4, 15]]


def star() -> list[list[float]]:
    turn = np.arange(10) * np.pi / 5
    radius = np.where(np.arange(10) % 2 == 0, 2.0, 0.5)
    return np.column_stack([9 + radius * np.cos(turn), radius * np.sin(turn), np.zeros(10)]).tolist()


@pytest.fixture
def mesh() -> Mesh:
    vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 1, 0], *star(), [0, 3, 0]]
    lines = [f"OFF\n{len(vertices)} {len(POLYGONS)} 0"]
    lines += [" ".join(map(str, vertex)) for vertex in vertices]
    lines += [" ".join(map(str, [len(polygon), *polygon])) for polygon in POLYGONS]
    return read_mesh(io.BytesIO("\n".join(lines).encode()))


def polygons_of(mesh: Mesh, part: np.ndarray) -> list[list[int]]:
    loops = corner_loops(mesh.faces, mesh.source_polygon, part)
    ends = np.cumsum(loops.sizes)
    corners = mesh.faces.reshape(-1)[loops.corners].tolist()
    return [corners[end - size : end] for end, size in zip(ends.tolist(), loops.sizes.tolist(), strict=True)]


def rotated(polygon: list[int]) -> list[int]:
    first = polygon.index(min(polygon))
    return polygon[first:] + polygon[:first]


def test_the_polygons_of_the_file_are_found_in_their_order(mesh: Mesh) -> None:
    found = polygons_of(mesh, np.zeros(len(mesh.faces), dtype=np.int32))
    assert [rotated(polygon) for polygon in found] == [rotated(polygon) for polygon in POLYGONS]
    loops = corner_loops(mesh.faces, mesh.source_polygon, np.zeros(len(mesh.faces), dtype=np.int32))
    assert mesh.source_polygon is not None
    assert mesh.source_polygon[loops.first_face].tolist() == [0, 1, 2, 3]


def test_a_polygon_of_two_parts_stays_triangles(mesh: Mesh) -> None:
    part = np.zeros(len(mesh.faces), dtype=np.int32)
    part[1] = 1  # the second half of the first quadrilateral
    found = polygons_of(mesh, part)
    assert found[:2] == mesh.faces[:2].tolist()
    assert [rotated(polygon) for polygon in found[2:]] == [rotated(polygon) for polygon in POLYGONS[1:]]


def test_faces_that_are_no_single_loop_stay_triangles() -> None:
    faces = np.array([[0, 1, 2], [3, 4, 5], [0, 2, 6]], dtype=np.int32)
    loops = corner_loops(faces, np.array([0, 0, 1], dtype=np.int32), np.zeros(3, dtype=np.int32))
    assert loops.sizes.tolist() == [3, 3, 3]
    assert faces.reshape(-1)[loops.corners].tolist() == faces.reshape(-1).tolist()
