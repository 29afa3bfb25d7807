"""A glTF file divided by part: the same triangles in the same places, and everything else as it was."""

import copy
import functools
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from helpers.files.compressed_gltf import DRACO, draco_asset, meshopt_asset
from helpers.files.gltf import FLOAT, UNSIGNED, Asset, assets
from helpers.files.kept import Opened, in_any_order, kept
from helpers.files.rich_gltf import (
    BLUE,
    BODY,
    COPIES,
    ELSEWHERE,
    INSTANCING,
    RED,
    STRIP,
    TWIN_A,
    TWIN_B,
    UNKNOWN,
    VARIANTS,
    rich_asset,
)
from helpers.files.samples import gltf_square
from helpers.hierarchies import hierarchy_of_labels
from helpers.node.programs import install, run
from segcore import shapes
from segcore.errors import CleaveError
from segcore.io import Original, read_mesh, write_kept_parts, write_mesh

UNCHANGED = ("asset", "animations", "cameras", "samplers", "skins", "textures")


def labelled(data: bytes, labels: np.ndarray, **options: Any) -> Opened:
    return Opened(kept(data, hierarchy_of_labels(labels), **options))


def halves(data: bytes, parts: int = 2) -> tuple[Opened, np.ndarray]:
    """The output with the faces in ``parts`` parts by turns, so that each primitive of several faces is divided."""
    labels = np.arange(len(read_mesh(io.BytesIO(data)).faces)) % parts
    return labelled(data, labels), labels


def primitives_of(opened: Opened, node: int) -> list[dict[str, Any]]:
    document = opened.document
    return document["meshes"][document["nodes"][node]["mesh"]]["primitives"]


@given(assets(), st.data())
@settings(suppress_health_check=[HealthCheck.filter_too_much], max_examples=80)
def test_every_part_has_its_faces_where_they_were(asset: Asset, data: st.DataObject) -> None:
    try:
        mesh = read_mesh(io.BytesIO(asset.glb()))
    except CleaveError:
        return
    labels = np.array(data.draw(st.lists(st.integers(0, 3), min_size=len(mesh.faces), max_size=len(mesh.faces))))
    labels = np.unique(labels, return_inverse=True)[1].reshape(-1)
    found = labelled(asset.glb(), labels, mesh=mesh).corners_by_part()
    assert sorted(found) == np.unique(labels).tolist()
    for part, corners in found.items():
        assert in_any_order(corners) == in_any_order(mesh.corners[labels == part])


def test_nodes_materials_and_all_else_stay() -> None:
    before = rich_asset().document
    after = halves(rich_asset().glb())[0].document
    for name in UNCHANGED:
        assert after[name] == before[name]
    assert after["extensions"][UNKNOWN] == {"value": 3}
    assert after["materials"][:2] == before["materials"]
    assert after["scenes"][1] == before["scenes"][1]
    assert after["scenes"][0]["nodes"] == before["scenes"][0]["nodes"]
    assert after["scenes"][0]["extras"]["of"] == "the scene"
    for node in (BODY, TWIN_A, ELSEWHERE, STRIP):
        assert {**after["nodes"][node], "mesh": 0} == {**before["nodes"][node], "mesh": 0}
    names = ("name", "weights", "extras")
    assert {name: after["meshes"][0][name] for name in names} == {name: before["meshes"][0][name] for name in names}
    assert set(before["extensionsUsed"]) | {VARIANTS} == set(after["extensionsUsed"])


def test_numbers_of_vertices_and_pictures_have_the_same_bytes() -> None:
    asset = rich_asset()
    opened, _ = halves(asset.glb())
    before, after = asset.document, opened.document
    indices = {entry["indices"] for mesh in before["meshes"] for entry in mesh["primitives"] if "indices" in entry}
    for i, entry in enumerate(before["accessors"]):
        if i not in indices:
            assert after["accessors"][i] == entry
            assert opened.numbers(i).tobytes() == Opened(asset.glb()).numbers(i).tobytes()
    assert [opened.picture(0), opened.picture(1)] == [RED, BLUE]
    assert [image["mimeType"] for image in after["images"]] == ["image/png"] * 2
    assert after["images"][0]["name"] == "red"


def test_the_parts_of_a_primitive_share_its_attributes_and_targets() -> None:
    asset = rich_asset()
    before = asset.document["meshes"][0]["primitives"]
    *pieces, points = primitives_of(halves(asset.glb())[0], BODY)
    assert points == before[1]
    assert len(pieces) == 2
    assert [piece["extras"] for piece in pieces] == [
        {"made by": "hand", "part": k, "name": f"segment {k}"} for k in range(2)
    ]
    for piece in pieces:
        for name in ("attributes", "targets", "material"):
            assert piece[name] == before[0][name]


def test_the_old_indices_leave_the_file() -> None:
    asset = rich_asset()
    asset.document["extensionsUsed"].remove(INSTANCING)
    del asset.document["nodes"][COPIES]["extensions"]
    asset.document["nodes"][ELSEWHERE].pop("mesh")
    opened, _ = halves(asset.glb())
    before, after = asset.document, opened.document
    new = sum(len(mesh["primitives"]) for mesh in after["meshes"]) - 1  # all but the points
    old = sum("indices" in entry for mesh in before["meshes"] for entry in mesh["primitives"])
    assert len(after["accessors"]) == len(before["accessors"]) + new - old
    everything = set(range(len(after["bufferViews"])))
    assert {entry["bufferView"] for entry in after["accessors"] + after["images"]} == everything


def test_an_unknown_extension_keeps_all_accessors() -> None:
    asset = rich_asset()
    asset.document["extensionsUsed"].append(UNKNOWN)
    opened, _ = halves(asset.glb())
    assert opened.document["accessors"][: len(asset.document["accessors"])] == asset.document["accessors"]


def test_nodes_with_one_mesh_and_different_parts_get_meshes_with_the_same_attributes() -> None:
    asset = rich_asset()
    mesh = read_mesh(io.BytesIO(asset.glb()))
    labels = np.zeros(len(mesh.faces), dtype=int)
    body = 32
    labels[body : body + 64] = 1  # the first twin
    labels[body + 64 : body + 96] = np.arange(32) % 2  # the second one, its first primitive
    opened = labelled(asset.glb(), labels)
    before = asset.document["meshes"][1]["primitives"]
    nodes = opened.document["nodes"]
    assert len({nodes[node]["mesh"] for node in (TWIN_A, TWIN_B, COPIES, ELSEWHERE)}) == 4
    assert opened.document["meshes"][nodes[ELSEWHERE]["mesh"]] == asset.document["meshes"][1]
    parts = {
        node: [entry["extras"]["part"] for entry in primitives_of(opened, node)] for node in (TWIN_A, TWIN_B, COPIES)
    }
    assert parts == {TWIN_A: [1, 1], TWIN_B: [0, 1, 0], COPIES: [0, 0]}
    assert {entry["attributes"]["POSITION"] for entry in primitives_of(opened, TWIN_B)} == {
        entry["attributes"]["POSITION"] for entry in before
    }
    assert [entry["indices"] for entry in primitives_of(opened, TWIN_A)] == [entry["indices"] for entry in before]


def test_copies_with_different_parts_become_children_and_equal_ones_stay_copies() -> None:
    asset = rich_asset()
    mesh = read_mesh(io.BytesIO(asset.glb()))
    first = 32 + 2 * 64
    labels = np.zeros(len(mesh.faces), dtype=int)
    labels[first + 64 : first + 128] = 1  # the second copy
    opened = labelled(asset.glb(), labels)
    document = opened.document
    node = document["nodes"][COPIES]
    assert {"mesh", "extensions"}.isdisjoint(node)
    found = {}
    for child in node["children"]:
        attributes = document["nodes"][child]["extensions"][INSTANCING]["attributes"]
        parts = {entry["extras"]["part"] for entry in primitives_of(opened, child)}
        found[parts.pop()] = (
            opened.numbers(attributes["TRANSLATION"])[:, 0].tolist(),
            opened.numbers(attributes["_ID"])[:, 0].tolist(),
        )
    assert found == {0: ([0.0, 12.0], [4.0, 6.0]), 1: ([6.0], [5.0])}
    everywhere = labelled(asset.glb(), np.zeros(len(mesh.faces), dtype=int)).document
    assert everywhere["nodes"][COPIES] | {"mesh": 1} == asset.document["nodes"][COPIES]


def test_a_strip_becomes_triangles_only_if_it_is_divided() -> None:
    data = rich_asset().glb()
    opened, labels = halves(data)
    pieces = primitives_of(opened, STRIP)
    assert [("mode" in piece, piece["extras"]["part"]) for piece in pieces] == [(False, 0), (False, 1)]
    whole = primitives_of(labelled(data, np.zeros(len(labels), dtype=int)), STRIP)
    assert [(piece["mode"], "indices" in piece) for piece in whole] == [(5, False)]


def test_a_large_mesh_has_indices_of_32_bits_and_a_small_one_of_16() -> None:
    for count, component in ((65535, UNSIGNED[2]), (65536, UNSIGNED[4])):
        asset = Asset()
        points = [(float(i), 0.0, 0.0) for i in range(count - 1)] + [(0.0, 1.0, 0.0)]
        last = count - 1
        asset.add(
            "meshes",
            {"primitives": [asset.primitive(asset.accessor(points, FLOAT), [0, 1, last, 1, 2, last], width=4)]},
        )
        asset.root(mesh=0)
        opened, _ = halves(asset.glb())
        used = {opened.document["accessors"][entry["indices"]]["componentType"] for entry in primitives_of(opened, 0)}
        assert used == {component}


def test_a_draco_primitive_is_decoded_only_if_it_is_divided() -> None:
    pytest.importorskip("DracoPy")
    asset = draco_asset()[0]
    asset.document["accessors"][0] |= {"min": [-9.0] * 3, "max": [9.0] * 3}
    data = asset.glb()
    mesh = read_mesh(io.BytesIO(data))
    opened, labels = halves(data)
    decoded = opened.numbers(0)
    entry = opened.document["accessors"][0]
    assert (entry["min"], entry["max"]) == (decoded.min(axis=0).tolist(), decoded.max(axis=0).tolist())
    assert DRACO not in json.dumps(opened.document)
    for part, corners in opened.corners_by_part().items():
        assert in_any_order(corners) == in_any_order(mesh.corners[labels == part])
    whole = labelled(data, np.zeros(len(mesh.faces), dtype=int)).document
    assert DRACO in whole["extensionsUsed"]
    assert DRACO in whole["meshes"][0]["primitives"][0]["extensions"]


def test_meshopt_attributes_stay_compressed() -> None:
    asset = meshopt_asset()
    mesh = read_mesh(io.BytesIO(asset.glb()))
    opened, labels = halves(asset.glb())
    for part, corners in opened.corners_by_part().items():
        assert in_any_order(corners) == in_any_order(mesh.corners[labels == part])
    source, view = (
        document["bufferViews"][document["accessors"][0]["bufferView"]]
        for document in (asset.document, opened.document)
    )
    before, after = (entry["extensions"]["EXT_meshopt_compression"] for entry in (source, view))
    at = after.pop("byteOffset")
    assert after == {name: value for name, value in before.items() if name != "byteOffset"}
    length = before["byteLength"]
    packed = asset.binary[before["byteOffset"] : before["byteOffset"] + length]
    assert packed in opened.data
    assert at % 4 == before["byteOffset"] % 4


def test_variants_show_the_original_and_every_level() -> None:
    asset = rich_asset()
    table = {"variants": [{"name": "night"}, {"name": "2 segments"}]}
    asset.document["extensions"][VARIANTS] = table
    night = {"material": 1, "variants": [0]}
    asset.document["meshes"][0]["primitives"][0]["extensions"] = {VARIANTS: {"mappings": [night]}}
    opened, _ = halves(asset.glb(), 3)
    document = opened.document
    names = [variant["name"] for variant in document["extensions"][VARIANTS]["variants"]]
    assert names == ["night", "2 segments", "original look", "1 segment", "2 segments (2)", "3 segments"]
    assert [material["name"] for material in document["materials"]] == [
        "paint",
        "steel",
        *(f"segment {k}" for k in range(3)),
    ]
    *pieces, _ = primitives_of(opened, BODY)
    material = [{} for _ in pieces]
    for piece, found in zip(pieces, material, strict=True):
        assert piece["material"] == 0
        mappings = piece["extensions"][VARIANTS]["mappings"]
        assert mappings[0] == night
        found |= {names[v]: mapping["material"] for mapping in mappings for v in mapping["variants"]}
    assert [found["original look"] for found in material] == [0, 0, 0]
    assert [found["1 segment"] for found in material] == [2, 2, 2]
    assert [found["2 segments (2)"] for found in material] == [2, 3, 2]
    assert [found["3 segments"] for found in material] == [2, 3, 4]
    bare = primitives_of(opened, STRIP)[0]
    assert "material" not in bare
    assert {v for mapping in bare["extensions"][VARIANTS]["mappings"] for v in mapping["variants"]} == {3, 4, 5}


def test_all_levels_divide_by_the_leaves_and_one_level_by_its_segments() -> None:
    data = rich_asset().glb()
    hierarchy = hierarchy_of_labels(np.arange(len(read_mesh(io.BytesIO(data)).faces)) % 5)
    for options, parts, variants in (({}, 3, 3), ({"all_levels": True}, 5, 5)):
        opened = Opened(kept(data, hierarchy, 3, **options))
        assert sorted(opened.corners_by_part()) == list(range(parts))
        assert len(opened.document["extensions"][VARIANTS]["variants"]) == 1 + variants
        extras = opened.document["scenes"][0]["extras"]
        assert (extras["segments"], extras["max_segments"], len(extras["split_node"])) == (3, 5, parts - 1)


def test_of_very_many_levels_only_some_are_variants() -> None:
    ball = shapes.icosphere(3)
    target = io.BytesIO()
    write_mesh(target, ball, "ply")
    opened = labelled(target.getvalue(), np.arange(len(ball.faces)))
    names = [variant["name"] for variant in opened.document["extensions"][VARIANTS]["variants"]]
    assert 400 < len(names) <= 1025
    assert names[:3] == ["original look", "1 segment", "2 segments"]
    assert names[-1] == f"{len(ball.faces)} segments"
    assert len(opened.corners_by_part()) == len(ball.faces)


def test_extras_that_would_be_replaced_are_kept() -> None:
    asset = rich_asset()
    asset.document["meshes"][0]["primitives"][0]["extras"] = {"name": "mine", "part": 8}
    asset.document["scenes"][0]["extras"] = [1, 2]
    opened, _ = halves(asset.glb())
    extras = primitives_of(opened, BODY)[1]["extras"]
    assert extras == {"name": "segment 1", "part": 1, "original": {"name": "mine", "part": 8}}
    assert opened.document["scenes"][0]["extras"]["original"] == [1, 2]


def test_the_input_is_not_changed_and_equal_inputs_give_equal_bytes() -> None:
    data = rich_asset().glb()
    assert halves(data)[0].data == halves(bytes(bytearray(data)))[0].data


_DEEP: Any = functools.reduce(lambda inner, _: {"index": [inner]}, range(400), {})
_JUNK = [None, -1, 2**60, "x", [], {}, [3], {"extensions": 1}, 1.5, True, 0, 1, float("nan"), _DEEP]


@given(st.data())
@settings(max_examples=300)
def test_a_damaged_document_gives_a_file_or_a_typed_error(data: st.DataObject) -> None:
    asset = rich_asset()
    labels = np.arange(len(read_mesh(io.BytesIO(asset.glb())).faces)) % 2
    holders: list[Any] = []
    _collect(asset.document, holders)
    for _ in range(data.draw(st.integers(1, 2))):
        holder = data.draw(st.sampled_from(holders))
        key = data.draw(st.sampled_from(list(holder) if isinstance(holder, dict) else list(range(len(holder)))))
        holder[key] = copy.deepcopy(data.draw(st.sampled_from(_JUNK)))
        holders = [entry for entry in holders if entry]
    try:
        opened = labelled(asset.glb(), labels)
    except CleaveError:
        return
    read_mesh(io.BytesIO(opened.data))
    try:
        write_kept_parts(io.BytesIO(), Original(io.BytesIO(asset.glb())), hierarchy_of_labels(labels))
    except CleaveError:
        return


def errors(issues: dict[str, Any]) -> set[str]:
    return {message["code"] for message in issues["messages"] if message["severity"] == 0}


def _collect(value: Any, holders: list[Any]) -> None:
    if isinstance(value, dict | list) and value:
        holders.append(value)
        for entry in value.values() if isinstance(value, dict) else value:
            _collect(entry, holders)


@pytest.mark.slow
def test_the_khronos_validator_finds_no_new_errors(tmp_path: Path) -> None:
    script = install("gltf_validator", tmp_path) / "validate.js"
    files = [rich_asset().glb(), gltf_square().glb(), meshopt_asset().glb()]
    paths = []
    for i, data in enumerate(files):
        for name, content in (("before", data), ("after", halves(data)[0].data)):
            paths.append(tmp_path / f"{i}-{name}.glb")
            paths[-1].write_bytes(content)
    issues = json.loads(run(script, [*map(str, paths)]))
    for before, after in zip(issues[::2], issues[1::2], strict=True):
        assert errors(after) <= errors(before), after["messages"]
    assert errors(issues[1]) == {"UNDECLARED_EXTENSION"}  # the unknown one
