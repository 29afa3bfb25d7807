"""The PLY writer: labels, colours and attributes are those of the mesh, as another program reads them."""

import io

import numpy as np
import trimesh
from hypothesis import given

from helpers.files.appearances import at_corners, looks, seamed
from helpers.files.hierarchies import segmentations, two_strips
from helpers.files.written import written
from segcore.appearance import Appearance
from segcore.hierarchy import Hierarchy
from segcore.io import read_mesh
from segcore.mesh import Mesh

Segmented = tuple[Mesh, Hierarchy, int]


@given(segmentations())
def test_ply_holds_every_vertex_and_every_face_with_its_label(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    raw = trimesh.load(io.BytesIO(written("ply", *segmented)), file_type="ply", process=False).metadata["_ply_raw"]
    faces = raw["face"]["data"]
    assert faces["label"].ravel().tolist() == hierarchy.labels(segments).tolist()
    assert faces["vertex_indices"]["f1"].tolist() == mesh.faces.tolist()
    axes = [raw["vertex"]["data"][axis].ravel().astype(float) for axis in "xyz"]
    assert np.stack(axes, axis=1).tolist() == mesh.vertices.tolist()


def test_faces_of_one_colour_in_ply_are_one_segment() -> None:
    mesh, hierarchy = two_strips()
    colors = trimesh.load(io.BytesIO(written("ply", mesh, hierarchy, 3)), file_type="ply", process=False).visual
    assert len(np.unique(colors.face_colors, axis=0)) == 3
    same = (colors.face_colors[:, None] == colors.face_colors[None]).all(axis=2)
    labels = hierarchy.labels(3)
    assert (same == (labels[:, None] == labels[None])).all()


def test_ply_keeps_the_attributes_of_vertices() -> None:
    mesh, hierarchy, look = seamed()
    plain = Appearance(normals=look.normals[:-1], uvs=look.uvs[:-1], colors=look.colors[:-1])
    data = written("ply", Mesh(mesh.vertices, mesh.faces, None, plain), hierarchy)
    rows = trimesh.load(io.BytesIO(data), file_type="ply", process=False).metadata["_ply_raw"]["vertex"]["data"]
    names = {"normals": ("nx", "ny", "nz"), "uvs": ("s", "t"), "colors": ("red", "green", "blue", "alpha")}
    for kind, values in plain.row_arrays.items():
        expected = [0, 1] + values * [1, -1] if kind == "uvs" else values  # PLY counts from the lower left
        assert np.stack([rows[name].ravel() for name in names[kind]], axis=1).tolist() == expected.tolist()


@given(looks())
def test_attributes_of_vertices_are_read_back_from_ply(looking: tuple[Mesh, Hierarchy]) -> None:
    mesh, hierarchy = looking
    back = read_mesh(io.BytesIO(written("ply", mesh, hierarchy, 1)), appearance=True)
    if len(mesh.appearance.extra_vertex):
        assert back.appearance is None
    else:
        assert at_corners(back) == at_corners(mesh)
