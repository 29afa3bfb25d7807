"""The OBJ writer: objects, materials and attributes are those of the mesh, as another program reads them."""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given

from helpers.files.appearances import seamed
from helpers.files.blender_program import blender_reads, needs_blender
from helpers.files.hierarchies import segmentations, two_strips
from helpers.files.written import members, written
from helpers.node.programs import install, run
from segcore.hierarchy import Hierarchy
from segcore.io.palette import color_bytes
from segcore.mesh import Mesh

Segmented = tuple[Mesh, Hierarchy, int]


@given(segmentations())
def test_objects_of_obj_hold_the_faces_of_their_segment_in_input_order(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    vertices, groups = plain_obj(written("obj", *segmented))
    labels = hierarchy.labels(segments)
    assert vertices == mesh.vertices.tolist()
    assert groups == {f"segment_{k}": (mesh.faces[labels == k] + 1).tolist() for k in range(segments)}


def plain_obj(data: bytes) -> tuple[list[list[float]], dict[str, list[list[int]]]]:
    """The vertices and the objects of an OBJ file without textures."""
    vertices: list[list[float]] = []
    groups: dict[str, list[list[int]]] = {}
    for words in map(str.split, data.decode().splitlines()):
        match words:
            case ["v", *values]:
                vertices.append([float(value) for value in values])
            case ["o", name]:
                groups[name] = []
            case ["f", *corners]:
                groups[name].append([int(corner) for corner in corners])
    return vertices, groups


def unpacked(folder: Path, names: dict[int, str] | None = None) -> tuple[Path, Mesh, list[int]]:
    """The archive of an OBJ file, unpacked, the mesh, and the labels of its faces."""
    mesh, hierarchy = two_strips()
    files = members(written("objzip", mesh, hierarchy, 3, names=names))
    assert list(files) == ["model.obj", "model.mtl"]
    for name, data in files.items():
        (folder / name).write_bytes(data)
    return folder / "model.obj", mesh, hierarchy.labels(3).tolist()


def test_trimesh_finds_the_objects_and_their_colours(tmp_path: Path) -> None:
    path, mesh, labels = unpacked(tmp_path, {1: "left wheel"})
    scene = trimesh.load_scene(path, split_objects=True, group_material=False)
    assert len(scene.geometry) == 3
    for label, name in enumerate(["segment_0", "left_wheel", "segment_2"]):
        part = scene.geometry[name]
        assert part.triangles.tolist() == mesh.corners[np.array(labels) == label].tolist()
        assert part.visual.material.diffuse[:3].tolist() == color_bytes(3)[label].tolist()


@pytest.mark.timeout(300)
def test_three_js_finds_the_objects_and_their_colours(tmp_path: Path) -> None:
    script = install("three", tmp_path) / "read.mjs"
    path, mesh, labels = unpacked(tmp_path, {1: "left wheel"})
    parts = json.loads(run(script, [], json.dumps([str(path)])))["parts"][str(path)]
    assert [part["name"] for part in parts] == ["segment_0", "left_wheel", "segment_2"]
    for label, part in enumerate(parts):
        assert np.reshape(part["corners"], (-1, 3, 3)).tolist() == mesh.corners[np.array(labels) == label].tolist()
        assert part["material"] == int(bytes(color_bytes(3)[label]).hex(), 16)


@needs_blender
@pytest.mark.timeout(300)
def test_blender_finds_the_objects_and_their_colours(tmp_path: Path) -> None:
    path, _, _ = unpacked(tmp_path)
    parts = blender_reads([path], tmp_path)[str(path)]
    assert [part["name"] for part in parts] == [f"segment_{k}" for k in range(3)]
    found = np.array([part["material"] for part in parts])
    np.testing.assert_allclose(found, color_bytes(3) / 255, rtol=0, atol=1e-3)


def test_an_obj_file_names_the_file_of_its_materials() -> None:
    mesh, hierarchy = two_strips()
    for options, name in (({}, "model.mtl"), ({"library": "a table.mtl"}, "a table.mtl")):
        lines = written("obj", mesh, hierarchy, 3, **options).decode().splitlines()
        assert [line for line in lines if line.startswith("mtllib")] == [f"mtllib {name}"]
        assert lines.index(f"mtllib {name}") < lines.index("o segment_0")


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
