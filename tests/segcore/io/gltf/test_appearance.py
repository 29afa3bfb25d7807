"""The appearance of glTF files: attributes of vertices, read and written."""

import io

import numpy as np
import pygltflib
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.appearances import at_corners, looks, read_look
from helpers.files.gltf import FLOAT
from helpers.files.samples import SQUARE, gltf_with_attributes
from helpers.files.written import written
from segcore.hierarchy import Hierarchy
from segcore.io import read_mesh
from segcore.mesh import Mesh


@given(looks(), st.booleans())
def test_glb_keeps_attributes_as_other_programs_read_them(looking: tuple[Mesh, Hierarchy], all_levels: bool) -> None:
    mesh, hierarchy = looking
    asset = pygltflib.GLTF2().load_from_bytes(written("glb", mesh, hierarchy, 2, all_levels=all_levels))
    attributes = {str(part.primitives[0].attributes.__dict__) for part in asset.meshes}
    assert len(attributes) == 1
    sources = asset.meshes[0].primitives[0].attributes
    named = {"normals": (sources.NORMAL, "<f4", 3), "uvs": (sources.TEXCOORD_0, "<f4", 2)}
    for name, (accessor, dtype, width) in (named | {"colors": (sources._COLOR_0, "u1", 4)}).items():
        entry = asset.accessors[accessor]
        view = asset.bufferViews[entry.bufferView]
        values = np.frombuffer(asset.binary_blob(), dtype, width * entry.count, view.byteOffset).reshape(-1, width)
        assert values.tolist() == getattr(mesh.appearance, name).tolist()
        assert entry.count == asset.accessors[sources.POSITION].count
    groups = [set(node.extras["groups"]) for node in asset.nodes if node.mesh is not None]
    assert set().union(*groups) == set(mesh.appearance.group_names)


@given(looks())
def test_glb_goes_round(looking: tuple[Mesh, Hierarchy]) -> None:
    mesh, hierarchy = looking
    back = read_mesh(io.BytesIO(written("glb", mesh, hierarchy, 1)), appearance=True)
    ours, theirs = at_corners(mesh), at_corners(back)
    assert (theirs["normals"], theirs["uvs"]) == (ours["normals"], ours["uvs"])
    assert back.corners.tolist() == mesh.corners.tolist()


def test_gltf_normals_turn_with_their_nodes_and_colours_become_srgb() -> None:
    asset = gltf_with_attributes()
    asset.root(mesh=0, scale=[1, 2, 1])
    asset.root(mesh=0, scale=[1, 1, -1])
    look = read_look(asset.glb())
    first, mirrored = np.array([0, 0.3, 0.8]), np.array([0, 0.6, -0.8])
    np.testing.assert_allclose(look.normals[:4], [first / np.linalg.norm(first)] * 4, atol=1e-6)
    np.testing.assert_allclose(look.normals[4:], [mirrored] * 4, atol=1e-6)
    assert look.uvs.tolist() == [[0.25, 0.5]] * 8
    assert look.colors.tolist() == [[255, 0, 128, 128]] * 8  # linear 55 / 255 is half of sRGB


def test_an_attribute_that_only_some_primitives_have_is_left_out() -> None:
    asset = gltf_with_attributes()
    asset.root(mesh=0)
    bare = asset.primitive(asset.accessor(SQUARE.vertices, FLOAT), [0, 1, 2])
    bare["attributes"]["NORMAL"] = 2
    asset.document["meshes"][0]["primitives"].append(bare)
    mesh = read_mesh(io.BytesIO(asset.glb()), appearance=True)
    assert mesh.appearance.uvs is mesh.appearance.colors is None
    assert len(mesh.faces) == 3


@pytest.mark.parametrize("accessor", [-1, -100, 10**6])
def test_an_attribute_without_its_accessor_is_left_out(accessor: int) -> None:
    asset = gltf_with_attributes()
    asset.root(mesh=0)
    asset.document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = accessor
    mesh = read_mesh(io.BytesIO(asset.glb()), appearance=True)
    assert mesh.appearance.uvs is None
    assert mesh.appearance.normals is not None
