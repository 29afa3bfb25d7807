"""Every writer: labels land on the faces they belong to, as another program reads them."""

import io
import struct

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings

from helpers.files.hierarchies import segmentations, two_strips
from helpers.files.polygon_soups import read
from helpers.files.written import json_of, labels_of_runs, members, written
from segcore import shapes
from segcore.appearance import Appearance
from segcore.errors import InvalidParameters, UnsupportedFormat
from segcore.hierarchy import Hierarchy
from segcore.io.labels import hierarchy_document
from segcore.io.parts.pieces import closed_parts
from segcore.io.parts.writer import write_parts
from segcore.io.threemf.writer import write_3mf
from segcore.io.writing import WRITERS, writer_for
from segcore.mesh import Mesh
from segcore.method import segment

Segmented = tuple[Mesh, Hierarchy, int]


@pytest.fixture(scope="module")
def burr() -> tuple[Mesh, Hierarchy]:
    """A ball with six arms, segmented."""
    mesh = shapes.burr().mesh
    return mesh, segment(mesh)


@pytest.mark.parametrize("kind", WRITERS)
def test_a_wrong_number_of_segments_is_refused_before_anything_is_written(kind: str) -> None:
    if kind == "cleave":
        pytest.skip("this file holds every level")
    for segments in (0, 4):
        with pytest.raises(InvalidParameters, match="1 to 3"):
            written(kind, *two_strips(), segments)


@given(segmentations())
@settings(max_examples=10)
def test_the_same_input_gives_the_same_bytes(segmented: Segmented) -> None:
    for kind in WRITERS:
        assert written(kind, *segmented) == written(kind, *segmented)


def test_a_writer_is_found_by_the_name_of_the_file() -> None:
    for kind, writer in WRITERS.items():
        assert writer_for(f"a.b{writer.extension.upper()}") is WRITERS[kind]
    with pytest.raises(UnsupportedFormat, match=r"\.dae.*\.glb, \.ply"):
        writer_for("hand.dae")


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


@given(segmentations())
def test_groups_of_obj_hold_the_faces_of_their_segment_in_input_order(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    vertices, groups = plain_obj(written("obj", *segmented))
    labels = hierarchy.labels(segments)
    assert vertices == mesh.vertices.tolist()
    assert groups == {f"segment_{k}": (mesh.faces[labels == k] + 1).tolist() for k in range(segments)}


def plain_obj(data: bytes) -> tuple[list[list[float]], dict[str, list[list[int]]]]:
    """The vertices and the groups of an OBJ file without textures."""
    vertices: list[list[float]] = []
    groups: dict[str, list[list[int]]] = {}
    for words in map(str.split, data.decode().splitlines()):
        match words:
            case ["v", *values]:
                vertices.append([float(value) for value in values])
            case ["g", name]:
                groups[name] = []
            case ["f", *corners]:
                groups[name].append([int(corner) for corner in corners])
    return vertices, groups


def test_trimesh_finds_the_groups_of_obj() -> None:
    mesh, hierarchy = two_strips()
    scene = trimesh.load(io.BytesIO(written("obj", mesh, hierarchy, 3)), file_type="obj", split_groups=True)
    labels = hierarchy.labels(3)
    found = [part.triangles.tolist() for part in scene.geometry.values()]
    assert sorted(found) == sorted(mesh.corners[labels == k].tolist() for k in range(3))


@given(segmentations())
def test_seg_npy_and_json_hold_the_labels(segmented: Segmented) -> None:
    _, hierarchy, segments = segmented
    labels = hierarchy.labels(segments).tolist()
    assert [int(line) for line in written("seg", *segmented).split()] == labels
    array = np.load(io.BytesIO(written("npy", *segmented)), allow_pickle=False)
    assert (array.dtype, array.tolist()) == (np.int32, labels)
    document = json_of(written("json", *segmented))
    assert labels_of_runs(document) == labels
    assert document["segments"] == segments
    assert 0 not in document["lengths"]
    assert all(a != b for a, b in zip(document["values"], document["values"][1:], strict=False))
    assert document["hierarchy"] == hierarchy_document(hierarchy)


@given(segmentations())
def test_trimesh_reads_the_objects_of_3mf_in_place(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    proper = [len({*face}) == 3 for face in mesh.faces.tolist()]
    labels = np.where(proper, hierarchy.labels(segments), -1)
    if labels.max() < 0:
        return
    scene = trimesh.load(io.BytesIO(written("3mf", *segmented)), file_type="3mf", process=False)
    found = {name: [] for name in scene.geometry}
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        assert (transform == np.eye(4)).all()
        found[name] = scene.geometry[name].triangles.tolist()
    expected = {f"segment {k}": mesh.corners[labels == k].tolist() for k in range(segments) if (labels == k).any()}
    assert found == expected


@given(segmentations())
def test_the_archive_of_parts_holds_every_face_once(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    labels = hierarchy.labels(segments)
    for part_format in ("stl", "obj"):
        files = members(written("zip", *segmented, part_format=part_format))
        assert sorted(files) == [f"segment_{k}.{part_format}" for k in range(segments)]
        for k in range(segments):
            corners = read(files[f"segment_{k}.{part_format}"], part_format).corners
            np.testing.assert_array_equal(corners.astype("f4"), mesh.corners[labels == k].astype("f4"))


def test_the_normals_of_stl_parts_are_those_of_the_faces() -> None:
    mesh, hierarchy = two_strips()
    data = members(written("zip", mesh, hierarchy, 1))["segment_0.stl"]
    part = trimesh.load(io.BytesIO(data), file_type="stl", process=False)
    assert struct.unpack_from("<3f", data, 84) == tuple(part.face_normals[0])


def test_parts_keep_their_order_in_a_list_of_files(burr: tuple[Mesh, Hierarchy]) -> None:
    files = list(members(written("zip", *burr, 12)))
    assert files == sorted(files)
    assert len(files) == 12


@pytest.mark.parametrize("segments", [1, 2, 7, 20, 64])
def test_capped_parts_are_closed_and_consistent(burr: tuple[Mesh, Hierarchy], segments: int) -> None:
    mesh, hierarchy = burr
    volume = 0.0
    for part in closed_parts(mesh, hierarchy, segments):
        solid = trimesh.Trimesh(part.vertices, part.faces, process=False)
        assert solid.is_watertight
        assert solid.is_winding_consistent
        volume += float(solid.volume)
    whole = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume
    if segments <= 7:  # the arms are cut off along nearly plane loops: next to nothing is lost between two caps
        assert volume == pytest.approx(whole, rel=1e-2)


@given(segmentations())
def test_the_border_of_a_capped_part_is_empty_whatever_it_was_before(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    for part in closed_parts(mesh, hierarchy, segments):
        flow: dict[tuple[int, int], int] = {}
        for face in part.faces.tolist():
            for a, b in zip(face, face[1:] + face[:1], strict=True):
                flow[min(a, b), max(a, b)] = flow.get((min(a, b), max(a, b)), 0) + (1 if a < b else -1)
        assert not any(count for (a, b), count in flow.items() if a != b)


@pytest.mark.parametrize("kind", ["3mf", "zip"])
def test_capped_files_hold_the_closed_parts(burr: tuple[Mesh, Hierarchy], kind: str) -> None:
    target = io.BytesIO()
    (write_3mf if kind == "3mf" else write_parts)(target, *burr, 7, capped=True)
    if kind == "3mf":
        parts = list(trimesh.load(target, file_type="3mf").geometry.values())
    else:
        parts = [trimesh.load(io.BytesIO(data), file_type="stl") for data in members(target.getvalue()).values()]
    assert len(parts) == 7
    assert all(part.is_watertight for part in parts)


def test_stl_parts_that_stl_cannot_hold_are_refused() -> None:
    mesh, hierarchy = two_strips(0.0, 1e60)
    with pytest.raises(InvalidParameters, match="OBJ"):
        written("zip", mesh, hierarchy)
    with pytest.raises(InvalidParameters, match="stl or obj"):
        written("zip", mesh, hierarchy, part_format="dae")
    files = members(written("zip", mesh, hierarchy, 1, part_format="obj"))
    assert read(files["segment_0.obj"]).corners.tolist() == mesh.corners.tolist()


def seamed() -> tuple[Mesh, Hierarchy, Appearance]:
    """Two strips of which vertex 0 has another normal and colour coordinate in face 2."""
    mesh, hierarchy = two_strips()
    rng = np.random.default_rng(3)
    rows = len(mesh.vertices) + 1
    corners = mesh.faces.copy()
    corners[2][mesh.faces[2] == mesh.faces[2][0]] = rows - 1
    normals = np.eye(3, dtype=np.float32)[rng.integers(0, 3, rows)]
    look = Appearance(
        normals=normals,
        uvs=rng.integers(0, 16, (rows, 2)).astype(np.float32) / 16,
        colors=rng.integers(0, 256, (rows, 4)).astype(np.uint8),
        extra_vertex=mesh.faces[2][:1],
        corners=corners,
    )
    return Mesh(mesh.vertices, mesh.faces, None, look), hierarchy, look


def test_obj_keeps_normals_and_texture_coordinates_of_every_corner() -> None:
    mesh, hierarchy, look = seamed()
    data = written("obj", mesh, hierarchy, 1).decode()
    tables = {
        key: [[float(x) for x in line.split()[1:]] for line in data.splitlines() if line.startswith(f"{key} ")]
        for key in ("v", "vt", "vn")
    }
    corners = [line.split()[1:] for line in data.splitlines() if line.startswith("f ")]
    rows = np.array([[[int(i) - 1 for i in corner.split("/")] for corner in face] for face in corners])
    np.testing.assert_array_equal(np.array(tables["v"])[rows[:, :, 0], :3], mesh.corners)
    np.testing.assert_allclose(np.array(tables["v"])[:, 3:], look.colors[:-1, :3] / 255, atol=1e-4)
    np.testing.assert_array_equal(np.array(tables["vt"])[rows[:, :, 1]], [0, 1] + look.uvs[look.corners] * [1, -1])
    np.testing.assert_array_equal(np.array(tables["vn"])[rows[:, :, 2]], look.normals[look.corners])


def test_ply_keeps_what_the_vertices_had() -> None:
    mesh, hierarchy, look = seamed()
    plain = Appearance(normals=look.normals[:-1], uvs=look.uvs[:-1], colors=look.colors[:-1])
    data = written("ply", Mesh(mesh.vertices, mesh.faces, None, plain), hierarchy)
    rows = trimesh.load(io.BytesIO(data), file_type="ply", process=False).metadata["_ply_raw"]["vertex"]["data"]
    names = {"normals": ("nx", "ny", "nz"), "uvs": ("s", "t"), "colors": ("red", "green", "blue", "alpha")}
    for kind, values in plain.row_arrays.items():
        expected = [0, 1] + values * [1, -1] if kind == "uvs" else values  # PLY counts from the lower left
        assert np.stack([rows[name].ravel() for name in names[kind]], axis=1).tolist() == expected.tolist()
