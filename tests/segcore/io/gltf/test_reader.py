"""The glTF reader: every triangle of the scene in its place, no other file opened, no file half read."""

import json
import math
import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.damage import damaged
from helpers.files.gltf import Asset, assets
from helpers.files.plain_readers import slow_gltf
from helpers.files.polygon_soups import read, read_or_none
from helpers.files.samples import SQUARE
from helpers.files.samples import gltf_square as square
from segcore.errors import CleaveError, InvalidMesh, LimitExceeded, UnsupportedFormat
from segcore.io import ReadLimits
from segcore.mesh import Mesh


def assert_has_corners(mesh: Mesh, corners: list[Any]) -> None:
    expected = np.array(corners)
    size = max(1.0, float(np.abs(expected).max()))
    np.testing.assert_allclose(mesh.corners, expected, rtol=0, atol=1e-12 * size)


@given(asset=assets(), binary=st.booleans())
def test_every_triangle_of_the_scene_keeps_its_place(asset: Asset, binary: bool) -> None:
    file = asset.glb() if binary else asset.gltf()
    corners = slow_gltf(file)
    if corners:
        assert_has_corners(read(file), corners)
    else:
        with pytest.raises(InvalidMesh, match="no faces"):
            read(file)


def test_vertices_are_bit_for_bit_those_of_the_file_and_shared_as_there() -> None:
    asset = square()
    asset.document["meshes"][0]["primitives"].append(asset.primitive(0, [3, 2, 1]))
    mesh = read(asset.glb())
    assert mesh.vertices.tolist() == [list(point) for point in SQUARE.vertices]
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3], [3, 2, 1]]
    assert mesh.source_polygon is None


@given(damaged([square().glb(), square().gltf()], b' \n{}[]",:0123456789-.\0\xff'))
def test_a_damaged_file_is_read_as_it_stands_or_refused(data: bytes) -> None:
    mesh = read_or_none(data)
    if mesh is not None:
        assert_has_corners(mesh, slow_gltf(data))


@pytest.mark.parametrize("data", [square().glb(), square().gltf()], ids=["glb", "gltf"])
def test_a_cut_file_is_never_read(data: bytes) -> None:
    for length in range(len(data)):
        with pytest.raises(CleaveError):
            read(data[:length])


def test_bytes_after_the_end_of_a_glb_are_passed_over() -> None:
    assert len(read(square().glb() + b"tail").faces) == 2


def test_a_mirrored_mesh_keeps_its_outside() -> None:
    asset = square()
    asset.document["nodes"][0]["scale"] = [-1, 1, 1]
    assert read(asset.glb()).faces.tolist() == [[0, 2, 1], [0, 3, 2]]


def test_instances_are_expanded_in_the_order_of_the_nodes() -> None:
    asset = square()
    asset.root(mesh=0, translation=[10, 0, 0])
    mesh = read(asset.glb())
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]
    assert mesh.vertices[4:].tolist() == [[x + 10, y, z] for x, y, z in SQUARE.vertices]


def test_without_scenes_all_trees_of_nodes_count() -> None:
    asset = square()
    asset.add("nodes", {"children": [0], "scale": [2, 2, 2]})
    del asset.document["scenes"]
    assert read(asset.glb()).vertices.tolist() == [[2 * x, 2 * y, 2 * z] for x, y, z in SQUARE.vertices]


def change(path: str, value: object) -> bytes:
    """The square with one member of its document replaced, or removed if the value is an ellipsis."""
    asset = square()
    *parents, last = [int(key) if key.isdigit() else key for key in path.split(".")]
    place: Any = asset.document
    for key in parents:
        place = place[key]
    if value is ...:
        del place[last]
    else:
        place[last] = value
    return asset.glb()


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("asset", {}, "asset.version"),
        ("scene", 3, r"scenes\[3\]"),
        ("scenes.0.nodes", [0, 0], r"nodes\[0\].*two parents"),
        ("nodes.0.children", [0], r"nodes\[0\].*two parents"),
        ("nodes.0.children", [7], r"nodes\[7\]"),
        ("nodes.0.mesh", -1, r"nodes\[0\].mesh"),
        ("nodes.0.mesh", 1, r"meshes\[1\]"),
        ("nodes.0.mesh", True, r"nodes\[0\].mesh"),
        ("nodes.0.matrix", [1] * 15, r"nodes\[0\].matrix .* must be 16 finite numbers"),
        ("nodes.0.scale", [1, 1, 10**400], r"nodes\[0\].scale"),
        ("nodes.0.scale", [1, 1, math.inf], r"nodes\[0\].scale"),
        ("nodes.0.scale", [1e200, 1, 1], "coordinate"),
        ("nodes.0.rotation", [0, 0, 0, 0], r"nodes\[0\].rotation"),
        ("meshes.0.primitives", {}, r"meshes\[0\].primitives"),
        ("meshes.0.primitives.0.attributes", {}, r"no faces.*without positions.*meshes\[0\].primitives\[0\]"),
        ("accessors.1.type", "VEC3", r"accessors\[1\].*SCALAR"),
        ("meshes.0.primitives.0.mode", 0, "no faces"),
        ("accessors.1.count", 5, "not a multiple of 3"),
        ("accessors.1.count", 2_000_000_001, "max_faces"),
        ("accessors.0.count", 3, "index 3, but 3 vertices"),
        ("accessors.0.count", 5, r"accessors\[0\].*reaches beyond"),
        ("accessors.0.count", -4, r"accessors\[0\].count"),
        ("accessors.0.componentType", 5124, "5124"),
        ("accessors.0.type", "VEC2", "VEC3"),
        ("accessors.1.componentType", 5122, "unsigned"),
        ("bufferViews.0.byteLength", 10**12, r"bufferViews\[0\].*beyond its buffer"),
        ("bufferViews.0.byteStride", 4, r"accessors\[0\].*reaches beyond"),
        ("bufferViews.0.buffer", 1, r"buffers\[1\]"),
    ],
)
def test_a_wrong_file_is_refused_with_the_element(path: str, value: object, message: str) -> None:
    with pytest.raises((InvalidMesh, LimitExceeded), match=message):
        read(change(path, value))


def test_an_accessor_without_data_is_all_zero() -> None:
    assert not read(change("accessors.0.bufferView", ...)).vertices.any()


@pytest.mark.parametrize("name", ["EXT_implicit_cylinder_region", "VENDOR_boxes"])
def test_an_extension_that_changes_the_geometry_is_refused_by_name(name: str) -> None:
    with pytest.raises(UnsupportedFormat, match=name):
        read(change("extensionsRequired", [name]))


@pytest.mark.parametrize("name", ["KHR_mesh_quantization", "KHR_materials_unlit", "KHR_texture_transform"])
def test_a_required_extension_that_does_not_change_the_geometry_is_accepted(name: str) -> None:
    assert len(read(change("extensionsRequired", [name])).faces) == 2


@pytest.mark.parametrize(
    "uri", ["mesh.bin", "/etc/passwd", "../mesh.bin", "http://localhost/mesh.bin", "file:///etc/passwd"]
)
def test_a_buffer_in_another_file_is_refused(uri: str) -> None:
    document = json.loads(square().gltf())
    document["buffers"][0]["uri"] = uri
    with pytest.raises(UnsupportedFormat, match=r"buffers\[0\].*is another file.*ZIP archive"):
        read(json.dumps(document).encode())


def test_other_versions_are_refused_as_such() -> None:
    with pytest.raises(UnsupportedFormat, match=r"version '1\.0'"):
        read(change("asset", {"version": "1.0"}))
    with pytest.raises(UnsupportedFormat, match="version '1'"):
        read(change("asset", {"version": 1}))
    with pytest.raises(UnsupportedFormat, match="GLB version 1"):
        read(struct.pack("<4sIII", b"glTF", 1, 16, 0))


def test_instances_beyond_the_limits_are_refused_by_name_before_they_are_made() -> None:
    asset = square()
    for shift in range(3):
        asset.root(mesh=0, translation=[shift + 1, 0, 0])
    assert len(read(asset.glb(), limits=ReadLimits(max_faces=8, max_vertices=16)).faces) == 8
    for limits, name in (
        (ReadLimits(max_faces=7), "max_faces = 7"),
        (ReadLimits(max_vertices=15), "max_vertices = 15"),
    ):
        with pytest.raises(LimitExceeded, match=name):
            read(asset.glb(), limits=limits)


def test_the_structure_has_the_nodes_and_the_materials_of_the_primitives() -> None:
    asset = square()
    mesh = asset.document["meshes"][0]
    first = {**mesh["primitives"][0], "material": 7}
    mesh["primitives"] = [first, {**first, "material": 2}, {**first, "material": "none"}]
    asset.root(mesh=0, name="same name")
    structure = read(asset.glb()).structure
    assert structure.group.tolist() == [0] * 6 + [1] * 6
    assert structure.material.tolist() == [0, 0, 1, 1, -1, -1] * 2
    assert read(square().glb()).structure.material is None
