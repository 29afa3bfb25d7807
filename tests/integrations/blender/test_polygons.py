"""A polygon has the label of the largest area of its triangles; files of triangles are read as they are."""

import io
from collections import defaultdict

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import segcore
from integrations.blender.polygons import encode_ply, polygon_labels, triangle_areas
from segcore.mesh import face_normals_and_areas
from segcore.shapes import burr

_TRIANGLES = st.lists(
    st.tuples(st.integers(0, 5), st.integers(0, 3), st.integers(0, 4)), min_size=1, max_size=30
)  # polygon, label, area


@given(_TRIANGLES)
def test_a_polygon_has_the_label_of_the_largest_area(drawn: list[tuple[int, int, int]]) -> None:
    numbers = sorted({polygon for polygon, _, _ in drawn})
    triangles = [(numbers.index(polygon), label, area) for polygon, label, area in drawn]
    areas: defaultdict[int, defaultdict[int, int]] = defaultdict(lambda: defaultdict(int))
    for polygon, label, area in triangles:
        areas[polygon][label] += area
    expected = [max(sorted(areas[i]), key=lambda label: areas[i][label]) for i in range(len(numbers))]
    columns = np.array(triangles, dtype=np.int32)
    found = polygon_labels(columns[:, 1], columns[:, 0], columns[:, 2].astype(np.float32), len(numbers))
    assert found.tolist() == expected


def test_triangles_keep_their_labels() -> None:
    labels = np.array([3, 0, 2, 2], dtype=np.int32)
    area = np.array([0.0, 1.0, 2.0, 0.0], dtype=np.float32)
    assert polygon_labels(labels, np.arange(4, dtype=np.int32), area, 4).tolist() == labels.tolist()


def test_areas_are_those_of_the_mesh() -> None:
    mesh = burr(2).mesh
    areas = triangle_areas(mesh.vertices.astype(np.float32), mesh.faces)
    assert np.allclose(areas, face_normals_and_areas(mesh.corners)[1], rtol=1e-4)


def test_cleave_reads_the_file_as_it_was() -> None:
    mesh = burr(2).mesh
    vertices = mesh.vertices.astype(np.float32)
    read = segcore.read_mesh(io.BytesIO(encode_ply(vertices, mesh.faces)), "ply")
    assert np.array_equal(read.vertices, vertices)
    assert np.array_equal(read.faces, mesh.faces)
