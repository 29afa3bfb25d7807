"""The PLY writer: labels, colours and attributes are those of the mesh, as another program reads them."""

import io
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given

from helpers.files.appearances import at_corners, looks, seamed
from helpers.files.blender_program import blender_reads, needs_blender
from helpers.files.hierarchies import segmentations, two_strips
from helpers.files.written import written
from segcore.appearance import Appearance
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io import read_mesh
from segcore.io.palette import color_bytes
from segcore.mesh import Mesh

Segmented = tuple[Mesh, Hierarchy, int]


@given(segmentations())
def test_ply_holds_every_vertex_and_every_face_with_its_label(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    data = written("ply", *segmented, colors="faces")
    raw = trimesh.load(io.BytesIO(data), file_type="ply", process=False).metadata["_ply_raw"]
    faces = raw["face"]["data"]
    assert faces["label"].ravel().tolist() == hierarchy.labels(segments).tolist()
    assert faces["vertex_indices"]["f1"].tolist() == mesh.faces.tolist()
    axes = [raw["vertex"]["data"][axis].ravel().astype(float) for axis in "xyz"]
    assert np.stack(axes, axis=1).tolist() == mesh.vertices.tolist()


@given(segmentations())
def test_vertices_are_divided_between_segments_and_nowhere_else(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    labels, palette = hierarchy.labels(segments), color_bytes(segments)
    raw = trimesh.load(io.BytesIO(written("ply", *segmented)), file_type="ply", process=False).metadata["_ply_raw"]
    rows, corners = raw["vertex"]["data"], raw["face"]["data"]["vertex_indices"]["f1"]
    source, label = rows["source_vertex"].ravel(), rows["label"].ravel()
    assert source[: len(mesh.vertices)].tolist() == list(range(len(mesh.vertices)))
    assert source[corners].tolist() == mesh.faces.tolist()
    assert (label[corners] == labels[:, None]).all()
    pairs = {(v, k) for face, k in zip(mesh.faces.tolist(), labels.tolist(), strict=True) for v in face}
    unused = {(v, -1) for v in set(range(len(mesh.vertices))) - {v for v, _ in pairs}}
    assert sorted(zip(source.tolist(), label.tolist(), strict=True)) == sorted(pairs | unused)
    axes = np.stack([rows[axis].ravel().astype(float) for axis in "xyz"], axis=1)
    assert axes.tolist() == mesh.vertices[source].tolist()
    colors = np.stack([rows[channel].ravel() for channel in ("red", "green", "blue", "alpha")], axis=1)
    assert (colors[label >= 0, :3] == palette[label[label >= 0]]).all()
    assert (colors[label < 0] == 255).all()
    assert (colors[:, 3] == 255).all()
    assert raw["face"]["data"]["label"].ravel().tolist() == labels.tolist()


def test_our_reader_finds_the_same_faces_in_the_colours_of_their_segments() -> None:
    mesh, hierarchy = two_strips()
    back = read_mesh(io.BytesIO(written("ply", mesh, hierarchy, 3)), appearance=True)
    assert back.corners.tolist() == mesh.corners.tolist()
    expected = np.broadcast_to(color_bytes(3)[hierarchy.labels(3)][:, None], (4, 3, 3))
    assert back.appearance.colors[back.faces][:, :, :3].tolist() == expected.tolist()


def test_unknown_colours_are_refused() -> None:
    with pytest.raises(InvalidParameters, match="vertices or faces"):
        written("ply", *two_strips(), 3, colors="edges")


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
    data = written("ply", Mesh(mesh.vertices, mesh.faces, None, plain), hierarchy, colors="faces")
    rows = trimesh.load(io.BytesIO(data), file_type="ply", process=False).metadata["_ply_raw"]["vertex"]["data"]
    names = {"normals": ("nx", "ny", "nz"), "uvs": ("s", "t"), "colors": ("red", "green", "blue", "alpha")}
    for kind, values in plain.row_arrays.items():
        expected = [0, 1] + values * [1, -1] if kind == "uvs" else values  # PLY counts from the lower left
        assert np.stack([rows[name].ravel() for name in names[kind]], axis=1).tolist() == expected.tolist()


@given(looks())
def test_attributes_of_vertices_are_read_back_from_ply(looking: tuple[Mesh, Hierarchy]) -> None:
    mesh, hierarchy = looking
    back = read_mesh(io.BytesIO(written("ply", mesh, hierarchy, 1, colors="faces")), appearance=True)
    if len(mesh.appearance.extra_vertex):
        assert back.appearance is None
    else:
        assert at_corners(back) == at_corners(mesh)


@given(looks())
def test_normals_and_texture_coordinates_stay_with_their_vertices(looking: tuple[Mesh, Hierarchy]) -> None:
    mesh, hierarchy = looking
    back = read_mesh(io.BytesIO(written("ply", mesh, hierarchy, 3)), appearance=True)
    assert set(at_corners(back)) == ({"colors"} if len(mesh.appearance.extra_vertex) else {"colors", "normals", "uvs"})
    for kind in set(at_corners(back)) - {"colors"}:
        assert at_corners(back)[kind] == at_corners(mesh)[kind]


@needs_blender
@pytest.mark.timeout(300)
def test_blender_shows_the_colours_and_has_the_labels(tmp_path: Path) -> None:
    mesh, hierarchy = two_strips()
    path = tmp_path / "strips.ply"
    path.write_bytes(written("ply", mesh, hierarchy, 3))
    (part,) = blender_reads([path], tmp_path)[str(path)]
    labels = hierarchy.labels(3)
    shown = np.reshape(part["colors"], (-1, 3, 3))
    np.testing.assert_allclose(shown, np.repeat(color_bytes(3)[labels][:, None] / 255, 3, axis=1), rtol=0, atol=2e-3)
    assert np.reshape(part["corners"], (-1, 3, 3)).tolist() == mesh.corners.tolist()
    assert sorted(set(part["attributes"]["label"])) == [-1, 0, 1, 2]
    assert part["attributes"]["source_vertex"][: len(mesh.vertices)] == list(range(len(mesh.vertices)))
