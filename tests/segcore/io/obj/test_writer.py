"""The OBJ writer: groups and attributes are those of the mesh, as another program reads them."""

import io

import numpy as np
import trimesh
from hypothesis import given

from helpers.files.appearances import seamed
from helpers.files.hierarchies import segmentations, two_strips
from helpers.files.written import written
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh

Segmented = tuple[Mesh, Hierarchy, int]


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
