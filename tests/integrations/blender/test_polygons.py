"""A polygon has the label of the largest area of the triangles that Cleave makes of it."""

import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import segcore
from integrations.blender.polygons import Polygons, digest
from segcore.mesh import Mesh, face_normals_and_areas
from segcore.shapes import burr


def rings(sizes: list[int]) -> Polygons:
    """Convex polygons of different shapes, none at the place of another."""
    number = np.repeat(np.arange(len(sizes)), sizes)
    corner = np.concatenate([np.arange(size) for size in sizes])
    angle = 2 * np.pi * (corner / np.array(sizes)[number]) ** (1 + 0.2 * (number % 3))
    points = np.stack([np.cos(angle), np.sin(angle), 3.0 * number], axis=1)
    return Polygons(points.astype(np.float32), np.arange(len(points), dtype=np.int32), np.array(sizes, dtype=np.int32))


def read(polygons: Polygons) -> Mesh:
    return segcore.read_mesh(io.BytesIO(polygons.ply()), "ply")


@given(st.lists(st.integers(3, 7), min_size=1, max_size=12), st.data())
def test_a_polygon_has_the_label_of_the_largest_area(sizes: list[int], data: st.DataObject) -> None:
    polygons = rings(sizes)
    mesh = read(polygons)
    count = polygons.triangle_count
    assert len(mesh.faces) == count
    labels = data.draw(st.lists(st.integers(0, 3), min_size=count, max_size=count))
    areas = face_normals_and_areas(mesh.corners)[1].tolist()
    source = range(count) if mesh.source_polygon is None else mesh.source_polygon.tolist()
    of_polygons = [[0.0] * 4 for _ in sizes]
    for polygon, label, area in zip(source, labels, areas, strict=True):
        of_polygons[polygon][label] += area
    found = polygons.labels(np.array(labels, dtype=np.int32))
    for chosen, of_labels in zip(found.tolist(), of_polygons, strict=True):
        assert of_labels[chosen] == pytest.approx(max(of_labels), rel=1e-5)


def test_cleave_reads_the_polygons_in_their_order() -> None:
    polygons = rings([3, 5, 4, 3])
    mesh = read(polygons)
    assert mesh.source_polygon is not None
    assert mesh.source_polygon.tolist() == [0, 1, 1, 1, 2, 2, 3]
    assert np.array_equal(mesh.vertices, polygons.vertices)
    assert mesh.faces[1].tolist() == [3, 4, 5]


def test_triangles_keep_their_labels() -> None:
    mesh = burr(2).mesh
    sizes = np.full(len(mesh.faces), 3, dtype=np.int32)
    polygons = Polygons(mesh.vertices.astype(np.float32), mesh.faces.ravel(), sizes)
    labels = np.arange(len(mesh.faces), dtype=np.int32)[::-1]
    assert np.array_equal(polygons.labels(labels), labels)
    assert np.array_equal(read(polygons).faces, mesh.faces)


def test_the_smallest_label_is_chosen_of_equal_areas() -> None:
    square = Polygons(np.float32([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.int32([0, 1, 2, 3]), np.int32([4]))
    assert square.labels(np.int32([5, 2])).tolist() == [2]


def test_most_triangles_decide_in_a_concave_polygon() -> None:
    arrow = np.float32([[0, 0, 0], [9, 1, 0], [0, 2, 0], [1, 1.2, 0], [1, 0.8, 0]])
    polygons = Polygons(arrow, np.arange(5, dtype=np.int32), np.int32([5]))
    assert polygons.labels(np.int32([1, 0, 1])).tolist() == [1]
    assert polygons.labels(np.int32([0, 1, 1])).tolist() == [1]


def test_other_bytes_have_another_name() -> None:
    assert digest(b"a", b"b") == digest(b"ab") != digest(b"ac")
