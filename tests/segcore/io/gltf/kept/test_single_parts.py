"""Parts alone: each file has the faces of its part, where they were, and only what they need of the input."""

import io
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from helpers.files.compressed_gltf import draco_asset, meshopt_asset
from helpers.files.gltf import Asset, assets
from helpers.files.kept import Opened, in_any_order
from helpers.files.rich_gltf import BLUE, INSTANCING, RED, VARIANTS, rich_asset
from helpers.files.written import members
from helpers.hierarchies import hierarchy_of_labels
from helpers.node.programs import install, run
from segcore.errors import CleaveError
from segcore.io import Original, read_mesh, write_kept_parts
from segcore.mesh import Mesh


def parts_of(data: bytes, labels: np.ndarray, **options: object) -> dict[str, Opened]:
    target = io.BytesIO()
    write_kept_parts(target, Original(io.BytesIO(data)), hierarchy_of_labels(labels), **options)
    return {name: Opened(content) for name, content in members(target.getvalue()).items()}


def corners(opened: Opened) -> np.ndarray:
    return np.concatenate(list(opened.corners_by_part().values()))


@given(assets(), st.data())
@settings(suppress_health_check=[HealthCheck.filter_too_much], max_examples=60)
def test_every_file_has_the_faces_of_its_part(asset: Asset, data: st.DataObject) -> None:
    try:
        mesh = read_mesh(io.BytesIO(asset.glb()))
    except CleaveError:
        return
    labels = np.array(data.draw(st.lists(st.integers(0, 2), min_size=len(mesh.faces), max_size=len(mesh.faces))))
    labels = np.unique(labels, return_inverse=True)[1].reshape(-1)
    found = parts_of(asset.glb(), labels)
    assert list(found) == [f"segment_{k}.glb" for k in range(labels.max() + 1)]
    for part, opened in enumerate(found.values()):
        assert in_any_order(corners(opened)) == in_any_order(mesh.corners[labels == part])
        for mesh_entry in opened.document["meshes"]:
            for primitive in mesh_entry["primitives"]:
                used = np.unique(opened.numbers(primitive["indices"]))
                rows = opened.document["accessors"][primitive["attributes"]["POSITION"]]["count"]
                assert used.tolist() == list(range(rows))


def test_a_part_takes_its_material_picture_skin_and_animation_along() -> None:
    mesh = read_mesh(io.BytesIO(rich_asset().glb()))
    labels = np.where(np.arange(len(mesh.faces)) < 32, 0, 1)
    labels[-6:] = 2
    body, twins, strip = parts_of(rich_asset().glb(), labels, names={0: "body"}).values()
    document = body.document
    assert [node["name"] for node in document["nodes"]] == ["Body of it", "root", "joint"]
    assert document["skins"] == [{"joints": [1, 2], "skeleton": 1}]
    (primitive,) = document["meshes"][0]["primitives"]
    assert document["meshes"][0]["weights"] == [0.5]
    assert primitive["extras"] == {"made by": "hand", "part": 0, "name": "body"}
    assert {"JOINTS_0", "WEIGHTS_0", "NORMAL", "TEXCOORD_0"} < set(primitive["attributes"])
    assert len(primitive["targets"]) == 1
    assert [material["name"] for material in document["materials"]] == ["paint"]
    assert [body.picture(i) for i in range(len(document["images"]))] == [RED]
    targets = [channel["target"] for channel in document["animations"][0]["channels"]]
    assert targets == [{"node": 2, "path": "translation"}, {"node": 0, "path": "weights"}]
    assert "extensionsUsed" not in document
    document = twins.document
    assert [node["name"] for node in document["nodes"]] == ["a.b:c", "twin", "row"]
    assert len(document["meshes"]) == 1
    assert [twins.picture(i) for i in range(len(document["images"]))] == [BLUE]
    assert document["extensionsUsed"] == [INSTANCING]
    assert [channel["target"]["node"] for channel in document["animations"][0]["channels"]] == [1]
    document = strip.document
    assert {"materials", "images", "animations", "skins"}.isdisjoint(document)
    assert VARIANTS not in json.dumps(document)


def test_compressed_primitives_become_plain_ones() -> None:
    pytest.importorskip("DracoPy")
    for data in (draco_asset()[0].glb(), meshopt_asset().glb()):
        mesh = read_mesh(io.BytesIO(data))
        labels = np.arange(len(mesh.faces)) * 2 // len(mesh.faces)
        for part, opened in enumerate(parts_of(data, labels).values()):
            assert in_any_order(corners(opened)) == in_any_order(mesh.corners[labels == part])
            assert "compression" not in json.dumps(opened.document)


def test_a_mesh_without_a_file_is_divided_as_well() -> None:
    mesh = read_mesh(io.BytesIO(rich_asset().glb()), appearance=True)
    labels = np.arange(len(mesh.faces)) % 2
    target = io.BytesIO()
    write_kept_parts(target, mesh, hierarchy_of_labels(labels))
    for part, data in enumerate(members(target.getvalue()).values()):
        again: Mesh = read_mesh(io.BytesIO(data))
        np.testing.assert_allclose(in_any_order(again.corners), in_any_order(mesh.corners[labels == part]), atol=1e-5)


@pytest.mark.slow
def test_the_khronos_validator_finds_no_errors(tmp_path: Path) -> None:
    script = install("gltf_validator", tmp_path) / "validate.js"
    labels = np.arange(len(read_mesh(io.BytesIO(rich_asset().glb())).faces)) * 5 // 400
    paths = []
    for name, opened in parts_of(rich_asset().glb(), labels).items():
        paths.append(str(tmp_path / name))
        Path(paths[-1]).write_bytes(opened.data)
    for issues in json.loads(run(script, paths)):
        assert issues["numErrors"] == 0, issues["messages"]
