"""Normals, texture coordinates, colours and names of groups: what holds for several formats."""

import io

import numpy as np
import pytest

from helpers.files.appearances import read_look
from helpers.files.hierarchies import two_strips
from helpers.files.ply import ENCODINGS, ply
from helpers.files.samples import DRESSED, INDICES, OBJ, OFF, SAMPLES, SQUARE, XYZ, gltf_square
from helpers.files.threemf import Model3MF
from segcore.appearance import Appearance
from segcore.errors import InvalidMesh, UnsupportedFormat
from segcore.io import read_mesh
from segcore.mesh import Mesh


@pytest.mark.parametrize(
    "data", [data for group in (SAMPLES, DRESSED) for samples in group.values() for data in samples]
)
def test_the_appearance_changes_neither_vertices_nor_faces(data: bytes) -> None:
    plain, kept = read_mesh(io.BytesIO(data)), read_mesh(io.BytesIO(data), appearance=True)
    assert plain.appearance is None
    assert kept.vertices.tolist() == plain.vertices.tolist()
    assert kept.faces.tolist() == plain.faces.tolist()


@pytest.mark.parametrize(("name", "data"), [(name, data) for name, samples in DRESSED.items() for data in samples])
def test_every_attribute_that_a_format_can_have_is_read(name: str, data: bytes) -> None:
    look = read_look(data)
    vertices = {"off", "ply", "obj", "glb", "gltf"}
    groups = {"stl", "obj", "glb", "gltf", "3mf"}
    assert (look.normals is not None) == (name in vertices)
    assert (look.face_group is not None) == (name in groups)


def test_solids_of_stl_and_objects_of_3mf_and_nodes_of_gltf_are_groups() -> None:
    facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n"
    stl = f"solid Left Wheel\n{facet}{facet}endsolid\nsolid axle\n{facet}endsolid axle\n".encode()
    model = Model3MF()
    model.item(model.mesh(SQUARE, "Left Wheel"))
    model.item(model.mesh(SQUARE, "axle"))
    asset = gltf_square()
    asset.document["nodes"][0]["name"] = "Left Wheel"
    asset.document["meshes"][0]["name"] = "axle"
    asset.root(mesh=0)
    for data in (stl, model.package(), asset.glb()):
        look = read_look(data)
        assert look.group_names == ("Left Wheel", "axle")
        assert look.face_group.tolist()[0] == 0
        assert look.face_group.tolist()[-1] == 1


def test_normals_without_direction_are_left_out() -> None:
    assert read_mesh(io.BytesIO(OBJ), appearance=True).appearance is None
    data = OFF.replace(b"OFF", b"NOFF").replace(b"0 0 0\n", b"0 0 0 0 0 0\n").replace(b"1 0 0\n", b"1 0 0 0 0 1\n")
    data = data.replace(b"1 1 0\n", b"1 1 0 0 0 1\n").replace(b"0 1 .5\n", b"0 1 .5 0 0 1\n")
    assert read_mesh(io.BytesIO(data), appearance=True).appearance is None


@pytest.mark.parametrize(
    "data",
    [
        b"OFF\n0 1 0\n3 0 1 2\n", b"STCNOFF\n0 1 0\n3 0 1 2\n", b"vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n",
        *(ply(name, [("vertex", XYZ, []), ("face", INDICES, [[[0, 1, 2]]])]) for name in ENCODINGS),
    ],
)  # fmt: skip
def test_a_file_without_vertices_is_refused_with_and_without_its_appearance(data: bytes) -> None:
    for appearance in (False, True):
        with pytest.raises((InvalidMesh, UnsupportedFormat)):
            read_mesh(io.BytesIO(data), appearance=appearance)


def test_an_appearance_of_another_mesh_is_refused() -> None:
    mesh, _ = two_strips()
    for look in (
        Appearance(normals=np.eye(3, dtype=np.float32)),
        Appearance(face_group=np.zeros(3, np.int32), group_names=("a",)),
        Appearance(uvs=np.zeros((11, 2), np.float32), extra_vertex=np.array([99], np.int32), corners=mesh.faces),
    ):
        with pytest.raises(InvalidMesh, match="do not match the numbers of vertices and faces"):
            Mesh(mesh.vertices, mesh.faces, None, look)
    with pytest.raises(InvalidMesh, match="list of names"):
        Appearance(face_group=np.array([1], np.int32), group_names=("a",))
    with pytest.raises(InvalidMesh, match="columns"):
        Appearance(normals=np.zeros((10, 2), np.float32))
