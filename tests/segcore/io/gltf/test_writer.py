"""The GLB writer: no face is lost, the nodes are the hierarchy, and other programs read the same."""

import io
import json
import struct
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.files.appearances import looks
from helpers.files.hierarchies import segmentations, two_strips
from helpers.files.polygon_soups import read
from helpers.node.programs import install, run
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io.gltf.writer import write_glb
from segcore.mesh import Mesh
from segcore.nary import nary_children

Segmented = tuple[Mesh, Hierarchy, int]


def glb(mesh: Mesh, hierarchy: Hierarchy, segments: int | None = None, **options: bool) -> bytes:
    target = io.BytesIO()
    write_glb(target, mesh, hierarchy, segments, **options)
    return target.getvalue()


def document(data: bytes) -> dict[str, Any]:
    (length,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20 : 20 + length])


def input_faces(data: bytes) -> list[int]:
    """The input faces in the order of the file, from the extras of the scene."""
    parsed = document(data)
    where = parsed["scenes"][0]["extras"]["input_faces"]
    view = parsed["bufferViews"][where["bufferView"]]
    binary = data[28 + struct.unpack_from("<I", data, 12)[0] :]
    assert view["byteLength"] == 4 * where["count"]
    return list(struct.unpack_from(f"<{where['count']}I", binary, view["byteOffset"]))


@given(segmentations())
def test_every_input_face_is_in_the_file_once_in_its_segment_and_in_input_order(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    data = glb(mesh, hierarchy, segments)
    order, labels = input_faces(data), hierarchy.labels(segments)
    ranges = {node["name"]: node["extras"] for node in document(data)["nodes"] if "mesh" in node}
    for k in range(segments):
        extras = ranges[f"segment {k}"]
        of_segment = order[extras["first_face"] :][: extras["faces"]]
        assert of_segment == np.flatnonzero(labels == k).tolist()
    assert sorted(order) == list(range(len(mesh.faces)))


def shown_children(hierarchy: Hierarchy, segments: int) -> dict[int, list[int]]:
    """The nodes of the n-ary tree of a level and their children."""
    children = nary_children(hierarchy.split_node[: segments - 1], hierarchy.step[: segments - 1])
    shown = {0, *(node for below in children for node in below)}
    return {node: children[node] for node in sorted(shown)}


@given(segmentations())
def test_the_nodes_are_those_of_the_tree_of_steps(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    nodes = document(glb(mesh, hierarchy, segments))["nodes"]
    expected = shown_children(hierarchy, segments)
    assert [node["extras"]["node"] for node in nodes] == list(expected)
    segment_nodes = hierarchy.segment_nodes(segments).tolist()
    for node in nodes:
        extras = node["extras"]
        i = extras["node"]
        assert (extras["level"], extras["faces"]) == (hierarchy.level[i], hierarchy.face_count[i])
        assert extras["area"] == hierarchy.area[i]
        if i in segment_nodes:
            assert node["name"] == f"segment {segment_nodes.index(i)}"
        else:
            assert node["name"] == f"group {i}"
            assert [nodes[child]["extras"]["node"] for child in node["children"]] == expected[i]


def test_equal_parts_are_children_of_one_node() -> None:
    mesh, hierarchy = two_strips()
    one_step = replace(hierarchy, step=np.zeros(2, dtype=np.int32))
    nodes = document(glb(mesh, one_step, 3))["nodes"]
    assert [node["name"] for node in nodes] == ["group 0", "segment 0", "segment 1", "segment 2"]
    assert nodes[0]["children"] == [1, 2, 3]
    assert [node["extras"]["node"] for node in nodes] == [0, 1, 3, 4]


@given(segmentations())
def test_trimesh_reads_the_same_faces(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    scene = trimesh.load(io.BytesIO(glb(mesh, hierarchy, segments)), file_type="glb", process=False)
    labels = hierarchy.labels(segments)
    assert len(scene.graph.nodes_geometry) == segments
    for name in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[name]
        corners = trimesh.transformations.transform_points(scene.geometry[geometry].triangles.reshape(-1, 3), transform)
        expected = mesh.corners[labels == int(name.removeprefix("segment "))]
        np.testing.assert_allclose(corners.reshape(-1, 3, 3), expected, rtol=1e-6, atol=1e-6)


@given(segmentations())
def test_pygltflib_reads_the_same_faces_from_one_shared_buffer(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    asset = pygltflib.GLTF2().load_from_bytes(glb(mesh, hierarchy, segments))
    labels, binary = hierarchy.labels(segments), asset.binary_blob()
    assert {primitive.attributes.POSITION for part in asset.meshes for primitive in part.primitives} == {0}
    assert asset.accessors[0].count == len(mesh.vertices)
    for k, part in enumerate(asset.meshes):
        (primitive,) = part.primitives
        accessor = asset.accessors[primitive.indices]
        at = asset.bufferViews[accessor.bufferView].byteOffset + (accessor.byteOffset or 0)
        faces = np.frombuffer(binary, "<u4", accessor.count, at).reshape(-1, 3)
        assert faces.tolist() == mesh.faces[labels == k].tolist()
        assert asset.materials[primitive.material].name == part.name == f"segment {k}"


@given(segmentations())
def test_our_own_reader_gets_the_mesh_back(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    data = glb(mesh, hierarchy, segments)
    corners = np.empty_like(mesh.corners)
    nested = [extras["first_face"] for extras in segments_in_scene_order(document(data))]
    counts = [extras["faces"] for extras in segments_in_scene_order(document(data))]
    order = [face for first, count in zip(nested, counts, strict=True) for face in input_faces(data)[first:][:count]]
    corners[order] = read(data).corners
    np.testing.assert_allclose(corners, mesh.corners, rtol=1e-6, atol=1e-6)


def segments_in_scene_order(parsed: dict[str, Any], node: int = 0) -> list[dict[str, Any]]:
    entry = parsed["nodes"][node]
    own = [entry["extras"]] if "mesh" in entry else []
    return own + [extras for child in entry.get("children", []) for extras in segments_in_scene_order(parsed, child)]


@given(segmentations())
@settings(max_examples=20)
def test_the_same_input_gives_the_same_bytes_and_no_segments_means_the_automatic_ones(segmented: Segmented) -> None:
    mesh, hierarchy, _ = segmented
    assert glb(mesh, hierarchy) == glb(mesh, hierarchy, hierarchy.automatic_segments)


@given(segmentations())
def test_every_variant_colours_every_face_as_its_segment_at_that_level(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    data = glb(mesh, hierarchy, segments, all_levels=True)
    parsed, order = document(data), input_faces(data)
    names = [variant["name"] for variant in parsed["extensions"]["KHR_materials_variants"]["variants"]]
    assert names == ["1 segment", *(f"{k} segments" for k in range(2, hierarchy.max_segments + 1))]
    shown, variants = np.full(len(order), -1), np.full((len(names), len(order)), -1)
    for node in parsed["nodes"]:
        if "mesh" in node:
            faces = order[node["extras"]["first_face"] :][: node["extras"]["faces"]]
            (primitive,) = parsed["meshes"][node["mesh"]]["primitives"]
            shown[faces] = primitive["material"]
            for mapping in primitive["extensions"]["KHR_materials_variants"]["mappings"]:
                variants[np.ix_(mapping["variants"], faces)] = mapping["material"]
    assert shown.tolist() == hierarchy.labels(segments).tolist()
    assert variants.tolist() == [hierarchy.labels(k + 1).tolist() for k in range(len(names))]


@given(segmentations())
def test_with_all_levels_the_nodes_are_the_whole_hierarchy(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    parsed = document(glb(mesh, hierarchy, segments, all_levels=True))
    cut_values = dict(zip(hierarchy.split_node.tolist(), hierarchy.cut_value.tolist(), strict=True))
    expected = shown_children(hierarchy, hierarchy.max_segments)
    nodes = parsed["nodes"]
    assert [node["extras"]["node"] for node in nodes] == list(expected)
    for node in nodes:
        extras = node["extras"]
        i = extras["node"]
        assert (extras["level"], extras["label"]) == (hierarchy.level[i], hierarchy.label[i])
        assert (extras["faces"], extras["area"]) == (hierarchy.face_count[i], hierarchy.area[i])
        assert ("mesh" in node) == (i not in cut_values) == ("children" not in node)
        assert extras["cut_value"] == (cut_values[i] if np.isfinite(cut_values.get(i, np.inf)) else None)
        if "children" in node:
            assert [nodes[child]["extras"]["node"] for child in node["children"]] == expected[i]
    scene = parsed["scenes"][0]["extras"]
    assert scene["split_node"] == hierarchy.split_node.tolist()
    assert scene["step"] == hierarchy.step.tolist()
    assert scene["cut_value"] == [value if np.isfinite(value) else None for value in hierarchy.cut_value.tolist()]
    assert scene["limit_reached"] is hierarchy.limit_reached
    assert (scene["segments"], scene["max_segments"]) == (segments, hierarchy.max_segments)
    assert scene["automatic_segments"] == hierarchy.automatic_segments


@given(segmentations())
def test_all_levels_hold_every_input_face_once(segmented: Segmented) -> None:
    mesh, hierarchy, _ = segmented
    data = glb(mesh, hierarchy, all_levels=True)
    corners = np.empty_like(mesh.corners)
    leaves = segments_in_scene_order(document(data))
    order = [face for leaf in leaves for face in input_faces(data)[leaf["first_face"] :][: leaf["faces"]]]
    assert sorted(order) == list(range(len(mesh.faces)))
    corners[order] = read(data).corners
    np.testing.assert_allclose(corners, mesh.corners, rtol=1e-6, atol=1e-6)


def test_a_segment_keeps_its_colour_at_every_level() -> None:
    mesh, hierarchy = two_strips()
    colors = [
        [
            material["pbrMetallicRoughness"]["baseColorFactor"]
            for material in document(glb(mesh, hierarchy, k))["materials"]
        ]
        for k in (1, 2, 3)
    ]
    assert colors[2][:1] == colors[0]
    assert colors[2][:2] == colors[1]
    assert len({tuple(color) for color in colors[2]}) == 3


def test_coordinates_of_float32_are_stored_as_they_are() -> None:
    mesh, hierarchy = two_strips()
    data = glb(mesh, hierarchy)
    assert read(data).corners.tolist() == mesh.corners[input_faces(data)].tolist()
    assert "translation" not in document(data)["nodes"][0]


@pytest.mark.parametrize(("offset", "size"), [(1e7, 1.0), (-5e5, 1e-3), (0.0, 1e-30), (0.0, 1e60), (1e-20, 1e-22)])
def test_meshes_far_away_tiny_or_huge_keep_their_shape(offset: float, size: float) -> None:
    mesh, hierarchy = two_strips(offset, size)
    data = glb(mesh, hierarchy, 1)
    positions = document(data)["accessors"][0]
    assert np.isfinite([positions["min"], positions["max"]]).all()
    assert np.ptp([positions["min"], positions["max"]]) > 0
    np.testing.assert_allclose(read(data).corners, mesh.corners, rtol=1e-12, atol=2e-7 * 4 * size)


def test_a_vertex_that_no_face_uses_neither_moves_the_others_nor_widens_their_box() -> None:
    mesh, hierarchy = two_strips()
    with_stray = Mesh(np.vstack([mesh.vertices, [1e30, 0, 0]]), mesh.faces)
    positions = document(glb(with_stray, hierarchy))["accessors"][0]
    assert positions["count"] == len(mesh.vertices) + 1
    assert (positions["min"], positions["max"]) == ([0, 0, 0], [1, 4, 0])


def test_a_wrong_number_of_segments_is_refused_before_anything_is_written() -> None:
    mesh, hierarchy = two_strips()
    target = io.BytesIO()
    with pytest.raises(InvalidParameters, match="1 to 3"):
        write_glb(target, mesh, hierarchy, 4)
    assert target.getvalue() == b""


@given(segmentations(), st.booleans())
def test_the_flat_layout_has_all_parts_below_the_root_in_the_order_of_their_labels(
    segmented: Segmented, all_levels: bool
) -> None:
    mesh, hierarchy, segments = segmented
    flat = document(glb(mesh, hierarchy, segments, layout="flat", all_levels=all_levels))
    tree = document(glb(mesh, hierarchy, segments, all_levels=all_levels))
    nodes = flat["nodes"]
    if "mesh" in nodes[0]:
        assert nodes == tree["nodes"]
        return
    assert [nodes[child]["mesh"] for child in nodes[0]["children"]] == list(range(len(flat["meshes"])))
    assert len(nodes) == len(flat["meshes"]) + 1
    parts = [[node for node in one["nodes"] if "mesh" in node] for one in (flat, tree)]
    assert parts[0] == parts[1]
    with pytest.raises(InvalidParameters, match="tree or flat"):
        glb(mesh, hierarchy, segments, layout="round")


@pytest.fixture(scope="module")
def validator(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The script of the Khronos validator."""
    return install("gltf_validator", tmp_path_factory.mktemp("gltf_validator")) / "validate.js"


@pytest.mark.slow
def test_the_khronos_validator_finds_no_errors_and_no_warnings(validator: Path, tmp_path: Path) -> None:
    cases: list[Segmented] = []
    for offset, size in ((0.0, 1.0), (1e7, 1.0), (0.0, 1e-30), (0.0, 1e30)):
        cases += [(*two_strips(offset, size), segments) for segments in (1, 2, 3)]

    @given(segmentations(), looks())
    @settings(max_examples=20, database=None, derandomize=True, deadline=None)
    def add_cases(segmented: Segmented, looking: tuple[Mesh, Hierarchy]) -> None:
        cases.extend([segmented, (*looking, 2)])

    add_cases()
    choices = [
        {"all_levels": all_levels, "features": features} for all_levels in (False, True) for features in (False, True)
    ]
    files = [glb(*segmented, **options) for segmented in cases for options in choices]
    paths = [tmp_path / f"{i}.glb" for i in range(len(files))]
    for path, data in zip(paths, files, strict=True):
        path.write_bytes(data)
    for issues in json.loads(run(validator, [*map(str, paths)])):
        assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"]
