"""The rest pose of glTF scenes: skins, morph targets and copies, as viewers show them before anything moves."""

import io
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from helpers.files.damage import damaged
from helpers.files.gltf import FLOAT, Asset
from helpers.files.polygon_soups import read, read_or_none
from helpers.files.posed import (
    BYTE,
    FIRST,
    SECOND,
    SHORT,
    UNSIGNED_BYTE,
    UNSIGNED_SHORT,
    WHOLE,
    blended,
    copied,
    instanced,
    morphed,
    shifted,
    skinned,
)
from helpers.files.samples import SQUARE, gltf_with_attributes
from helpers.files.samples import gltf_square as square
from helpers.node.programs import install, run
from segcore.errors import InvalidMesh, LimitExceeded
from segcore.io import ReadLimits, read_mesh

POINTS = np.array(SQUARE.vertices)


def positions(asset: Asset) -> np.ndarray:
    return read(asset.glb()).vertices


@pytest.mark.parametrize("component", [UNSIGNED_BYTE, UNSIGNED_SHORT])
def test_a_skin_moves_each_vertex_with_its_joint_and_not_with_its_node(component: int) -> None:
    joints = [*FIRST[:2], *SECOND[:2]]
    moved = 2 * POINTS + np.array([[20, 0, 0]] * 2 + [[0, 40, 0]] * 2)
    assert positions(skinned(joints, WHOLE, component=component)).tolist() == moved.tolist()


def test_inverse_bind_matrices_come_before_the_joints() -> None:
    binds = [shifted(1, 2, 3, 0.5), shifted(0, 0, 0)]
    moved = 2 * (0.5 * POINTS + [1, 2, 3] + [10, 0, 0])
    np.testing.assert_allclose(positions(skinned(FIRST, WHOLE, binds)), moved)


@pytest.mark.parametrize(
    ("weights", "component"),
    [
        ((0.25, 0.75, 0, 0), FLOAT),
        ((0.5, 1.5, 0, 0), FLOAT),
        ((50, 150, 0, 0), UNSIGNED_BYTE),
        ((16384, 49152, 0, 0), UNSIGNED_SHORT),
    ],
)
def test_weights_are_of_any_type_and_count_as_shares(weights: tuple[float, ...], component: int) -> None:
    asset = skinned([(0, 1, 77, 0)] * 4, [weights] * 4, weight_component=component)
    np.testing.assert_allclose(positions(asset), 2 * POINTS + [5, 30, 0])


def test_without_weights_the_first_joint_moves_a_vertex() -> None:
    assert positions(skinned(SECOND, [(0.0, 0, 0, 0)] * 4)).tolist() == (2 * POINTS + [0, 40, 0]).tolist()


def test_all_sets_of_joints_count() -> None:
    asset = skinned(FIRST, WHOLE)
    attributes = asset.document["meshes"][0]["primitives"][0]["attributes"]
    attributes["JOINTS_1"] = asset.accessor(SECOND, UNSIGNED_SHORT)
    attributes["WEIGHTS_1"] = asset.accessor([(0, 0, 3.0, 0)] * 4, FLOAT)
    attributes["JOINTS_1"] = asset.accessor([(0, 0, 1, 0)] * 4, UNSIGNED_SHORT)
    np.testing.assert_allclose(positions(asset), 2 * POINTS + [5, 30, 0])
    attributes |= {f"{name}_{k}": attributes[f"{name}_1"] for name in ("JOINTS", "WEIGHTS") for k in range(2, 12)}
    with pytest.raises(LimitExceeded, match="more than 32 joints"):
        read(asset.glb())


def test_a_primitive_without_joints_moves_with_its_node() -> None:
    asset = skinned(FIRST, WHOLE)
    del asset.document["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"]
    assert positions(asset).tolist() == (POINTS + 100).tolist()


def test_joints_outside_the_scene_are_where_their_trees_have_them() -> None:
    asset = skinned(SECOND, WHOLE)
    asset.document["scenes"][0]["nodes"] = [0]
    assert positions(asset).tolist() == (2 * POINTS + [0, 40, 0]).tolist()


def test_a_skin_that_mirrors_keeps_the_outside_outside() -> None:
    asset = skinned(FIRST, WHOLE)
    assert read(asset.glb()).faces.tolist() == [[0, 1, 2], [0, 2, 3]]
    asset.document["nodes"][1]["scale"] = [-1, 1, 1]
    mesh = read(asset.glb())
    assert mesh.faces.tolist() == [[0, 2, 1], [0, 3, 2]]
    np.testing.assert_allclose(mesh.vertices, POINTS * [-2, 2, 2] + [20, 0, 0])


def test_normals_follow_the_skin_and_the_morph_targets() -> None:
    asset = gltf_with_attributes()
    primitive = asset.document["meshes"][0]["primitives"][0]
    primitive["attributes"] |= {
        "JOINTS_0": asset.accessor(FIRST, UNSIGNED_BYTE),
        "WEIGHTS_0": asset.accessor(WHOLE, FLOAT),
    }
    joint = asset.root(scale=[1, 2, -1])
    asset.document["skins"] = [{"joints": [joint]}]
    asset.root(mesh=0, skin=0)
    normals = read_mesh(io.BytesIO(asset.glb()), appearance=True).appearance.normals
    expected = np.array([0, 0.3, -0.8])
    np.testing.assert_allclose(normals, [expected / np.linalg.norm(expected)] * 4, atol=1e-6)

    shift = asset.accessor([(0.0, -0.6, 0.2)] * 4, FLOAT)
    primitive["targets"] = [{"POSITION": primitive["attributes"]["POSITION"], "NORMAL": shift}]
    asset.document["meshes"][0]["weights"] = [1]
    normals = read_mesh(io.BytesIO(asset.glb()), appearance=True).appearance.normals
    np.testing.assert_allclose(normals, [[0, 0, -1]] * 4, atol=1e-6)
    del primitive["targets"][0]["NORMAL"]
    assert read_mesh(io.BytesIO(asset.glb()), appearance=True).appearance.normals is None


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda asset: asset.document["skins"].clear(), r"skins\[0\]"),
        (lambda asset: asset.document["skins"][0].update(joints=[]), r"skins\[0\].*no joints"),
        (lambda asset: asset.document["skins"][0].update(joints=[1]), r"skins\[0\].*1 joints.*joint 1"),
        (lambda asset: asset.document["skins"][0].update(joints=[1, 99]), r"skins\[0\].*nodes\[99\]"),
        (lambda asset: asset.document["skins"][0].update(inverseBindMatrices=0), "MAT4"),
        (lambda asset: asset.document["nodes"][0].update(skin=-1), r"nodes\[0\].skin"),
        (lambda asset: asset.document["nodes"][2].update(children=[3]), r"nodes\[3\]|two parents"),
        (lambda asset: asset.document["accessors"][2].update(componentType=BYTE), "unsigned"),
        (lambda asset: asset.document["accessors"][2].update(count=3), r"accessors\[2\].* 3 vertices"),
        (lambda asset: asset.document["accessors"][3].update(count=3), r"accessors\[3\].* 3 vertices"),
        (lambda asset: asset.document["accessors"][3].update(type="VEC3"), "VEC4"),
    ],
)
def test_a_wrong_skin_is_refused_with_the_element(change: Any, message: str) -> None:
    asset = skinned(SECOND, WHOLE)
    change(asset)
    with pytest.raises(InvalidMesh, match=message):
        read(asset.glb())


def test_numbers_of_skins_that_are_not_finite_are_refused() -> None:
    with pytest.raises(InvalidMesh, match=r"inverseBindMatrices.*not finite"):
        read(skinned(FIRST, WHOLE, [shifted(math.nan, 0, 0)] * 2).glb())
    with pytest.raises(InvalidMesh, match=r"skins\[0\].*2 joints.*fewer"):
        read(skinned(FIRST, WHOLE, [shifted(0, 0, 0)]).glb())
    with pytest.raises(InvalidMesh, match="weight that is not finite"):
        read(skinned(FIRST, [(math.inf, 0, 0, 0)] * 4).glb())


def test_morph_targets_have_the_weights_of_the_node_else_of_the_mesh_else_none() -> None:
    assert positions(morphed()).tolist() == POINTS.tolist()
    assert positions(morphed([0.5, 3])).tolist() == np.add(POINTS, [3, 0, 2]).tolist()
    asset = morphed([0.5, 3])
    asset.document["nodes"][0] |= {"weights": [0, 1], "scale": [2, 2, 2]}
    asset.root(mesh=0)
    assert positions(asset).tolist() == [*(2 * POINTS + [2, 0, 0]).tolist(), *np.add(POINTS, [3, 0, 2]).tolist()]


def test_a_sparse_morph_target_moves_a_few_vertices() -> None:
    asset = morphed([1, 0])
    sparse = asset.document["accessors"][2]
    del sparse["bufferView"]
    sparse["sparse"] = {
        "count": 1,
        "indices": {"bufferView": asset.view([(2,)], UNSIGNED_BYTE), "componentType": UNSIGNED_BYTE},
        "values": {"bufferView": asset.view([(0.0, 0, 4)], FLOAT)},
    }
    assert positions(asset).tolist() == (POINTS + np.outer([0, 0, 1, 0], [0, 0, 4])).tolist()


def test_morph_targets_come_before_the_skin() -> None:
    asset = skinned(FIRST, WHOLE)
    primitive = asset.document["meshes"][0]["primitives"][0]
    primitive["targets"] = [{"POSITION": asset.accessor([(0.0, 0, 4)] * 4, FLOAT)}]
    asset.document["meshes"][0]["weights"] = [0.25]
    assert positions(asset).tolist() == (2 * np.add(POINTS, [0, 0, 1]) + [20, 0, 0]).tolist()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda asset: asset.document["accessors"][2].update(count=3), r"accessors\[2\].*3 vertices"),
        (lambda asset: asset.document["meshes"][0].update(weights=[math.nan]), r"meshes\[0\].weights"),
        (lambda asset: asset.document["nodes"][0].update(weights="1"), r"nodes\[0\].weights"),
        (lambda asset: asset.document["meshes"][0]["primitives"][0].update(targets=[1]), r"primitives\[0\].targets"),
        (
            lambda asset: asset.document["meshes"][0]["primitives"][0].update(targets=[{"POSITION": -1}]),
            r"primitives\[0\].targets\[0\].POSITION",
        ),
    ],
)
def test_a_wrong_morph_target_is_refused_with_the_element(change: Any, message: str) -> None:
    asset = morphed([1])
    change(asset)
    with pytest.raises(InvalidMesh, match=message):
        read(asset.glb())


def test_many_morph_targets_are_refused_before_they_are_added() -> None:
    asset = morphed([1, 1])
    assert len(read(asset.glb(), limits=ReadLimits(max_vertices=8)).faces) == 2
    with pytest.raises(LimitExceeded, match="8 vertices of morph targets"):
        read(asset.glb(), limits=ReadLimits(max_vertices=7))


@pytest.mark.parametrize("required", [False, True])
@pytest.mark.parametrize("component", [FLOAT, BYTE, SHORT])
def test_copies_have_the_transform_of_the_node_times_their_own(required: bool, component: int) -> None:
    asset = instanced()
    full = {FLOAT: 1, BYTE: 127, SHORT: 32767}[component]
    asset.document["nodes"][0] |= {"scale": [10, 10, 10], "name": "leaf"}
    asset.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        "TRANSLATION": asset.accessor([(0.0, 0, 0), (5, 0, 0)], FLOAT),
        "ROTATION": asset.accessor([(0, 0, 0, full), (full, 0, 0, 0)], component, normalized=component != FLOAT),
        "SCALE": asset.accessor([(1.0, 1, 1), (-2, 2, 2)], FLOAT),
        "_ID": 99,
    }
    if required:
        asset.document["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
    mesh = read_mesh(io.BytesIO(asset.glb()), appearance=True)
    np.testing.assert_allclose(mesh.vertices[:4], 10 * POINTS)
    np.testing.assert_allclose(mesh.vertices[4:], 10 * (POINTS * [-2, -2, -2] + [5, 0, 0]), atol=1e-12)
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]]
    assert mesh.structure.group.tolist() == [0, 0, 1, 1]
    assert mesh.appearance.group_names == ("leaf",)


def test_very_many_copies_are_refused_before_they_are_made() -> None:
    for count, message in ((10**9, "max_faces"), (200_000, "200000 copies")):
        asset = instanced()
        shifts = asset.accessor([(0.0, 0, 0)], FLOAT)
        asset.document["accessors"][shifts]["count"] = count
        asset.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = shifts
        with pytest.raises(LimitExceeded, match=message):
            read(asset.glb())


@pytest.mark.parametrize(
    ("attributes", "message"),
    [
        ({"TRANSLATION": 77}, r"accessors\[77\]"),
        ({"TRANSLATION": -1}, r"nodes\[0\].extensions.EXT_mesh_gpu_instancing.TRANSLATION"),
        ({"TRANSLATION": 0, "SCALE": 2}, "differ in their numbers"),
        ({"SCALE": 3}, "not finite"),
        ({"ROTATION": 4}, "ROTATION .* is not a rotation"),
    ],
)
def test_wrong_copies_are_refused_with_the_element(attributes: dict[str, int], message: str) -> None:
    asset = instanced(**attributes)
    asset.accessor([(0.0, 0, 0)], FLOAT)
    asset.accessor([(0.0, 0, math.nan)], FLOAT)
    asset.accessor([(0.0, 0, 0, 0)], FLOAT)
    with pytest.raises(InvalidMesh, match=message):
        read(asset.glb())


def copied_with_a_skin() -> Asset:
    asset = skinned(FIRST, WHOLE)
    attributes = {"TRANSLATION": asset.accessor([(0.0, 0, 0), (5, 0, 0)], FLOAT)}
    asset.document["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    return asset


def test_copies_have_no_skin() -> None:
    mesh = read(copied_with_a_skin().glb())
    assert mesh.vertices.tolist() == [*(POINTS + 100).tolist(), *np.add(POINTS, [105, 100, 100]).tolist()]
    assert mesh.notes == ("The skin of nodes[0] is left out, because nodes[0] has copies (EXT_mesh_gpu_instancing).",)


def test_primitives_that_are_no_triangles_in_space_are_left_out_and_noted() -> None:
    asset = square()
    primitives = asset.document["meshes"][0]["primitives"]
    primitives += [asset.primitive(0, mode=mode) for mode in (0, 1)]
    primitives += [{"attributes": {}}, {"attributes": {"NORMAL": 0}}, asset.primitive(0, [0, 1], mode=5)]
    mesh = read(asset.glb())
    assert mesh.vertices.tolist() == POINTS.tolist()
    assert len(mesh.faces) == 2
    assert mesh.notes == (
        "2 primitives of points or lines are left out: meshes[0].primitives[1], meshes[0].primitives[2].",
        "2 primitives without positions are left out: meshes[0].primitives[3], meshes[0].primitives[4].",
        "1 primitive without faces is left out: meshes[0].primitives[5].",
    )
    del primitives[0]
    with pytest.raises(InvalidMesh, match=r"no faces that can be read.*of points or lines"):
        read(asset.glb())
    primitives += [{"attributes": {}}] * 10
    with pytest.raises(InvalidMesh, match="and 7 more"):
        read(asset.glb())


@given(damaged([blended().glb(), copied().glb(), morphed([0.5, 3]).glb()], b' \n{}[]",:0123456789-.\0\xff'))
def test_a_damaged_file_gives_a_mesh_or_a_typed_error(data: bytes) -> None:
    read_or_none(data)


@pytest.mark.timeout(300)
def test_three_js_has_every_corner_at_the_same_place(tmp_path: Path) -> None:
    assets = {
        "blended": blended(),
        "copied": copied(),
        "copied with a skin": copied_with_a_skin(),
        "morphed": morphed([0.5, 3]),
    }
    paths = {name: tmp_path / f"{name}.glb" for name in assets}
    for name, asset in assets.items():
        paths[name].write_bytes(asset.glb())
    script = install("three", tmp_path) / "read.mjs"
    found = json.loads(run(script, [], json.dumps([str(path) for path in paths.values()])))["parts"]
    for name, asset in assets.items():
        corners = np.concatenate([np.reshape(part["corners"], (-1, 3, 3)) for part in found[str(paths[name])]])
        np.testing.assert_allclose(read(asset.glb()).corners, corners, atol=1e-5)
