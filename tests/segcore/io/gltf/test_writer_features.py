"""Feature ids of GLB files: those of a face are the row of its node, and the table is the hierarchy."""

import itertools
import json
import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.appearances import looks
from helpers.files.hierarchies import segmentations, two_strips
from helpers.files.written import written
from segcore.hierarchy import Hierarchy
from segcore.io.labels import node_documents
from segcore.mesh import Mesh

Segmented = tuple[Mesh, Hierarchy, int]
COMPONENTS = {"INT32": "<i4", "UINT32": "<u4", "FLOAT64": "<f8"}


class Glb:
    """A GLB file, parsed according to the specifications."""

    def __init__(self, data: bytes) -> None:
        (length,) = struct.unpack_from("<I", data, 12)
        self.document: dict[str, Any] = json.loads(data[20 : 20 + length])
        self.binary = data[28 + length :]

    def view(self, index: int, dtype: str) -> np.ndarray:
        entry = self.document["bufferViews"][index]
        assert entry["byteOffset"] % np.dtype(dtype).itemsize == 0
        assert entry["byteOffset"] + entry["byteLength"] <= self.document["buffers"][0]["byteLength"]
        return np.frombuffer(self.binary[entry["byteOffset"] :][: entry["byteLength"]], dtype)

    def indices(self, primitive: dict[str, Any]) -> np.ndarray:
        entry = self.document["accessors"][primitive["indices"]]
        return self.view(entry["bufferView"], "<u4")[entry["byteOffset"] // 4 :][: entry["count"]]

    def feature_ids(self, primitive: dict[str, Any], feature: dict[str, Any]) -> np.ndarray:
        """(C,) feature ids of the corners of a primitive."""
        entry = self.document["accessors"][primitive["attributes"][f"_FEATURE_ID_{feature['attribute']}"]]
        assert (entry["componentType"], entry["type"]) == (5126, "SCALAR")
        assert entry["count"] == self.document["accessors"][primitive["attributes"]["POSITION"]]["count"]
        ids = self.view(entry["bufferView"], "<f4")
        assert len(ids) == entry["count"]
        assert feature["featureCount"] == len(set(ids.tolist()) - {feature["nullFeatureId"]})
        return ids[self.indices(primitive)]

    def column(self, table: dict[str, Any], kind: dict[str, Any], name: str) -> list[Any]:
        stored = table["properties"][name]
        if kind["type"] == "STRING":
            text = self.view(stored["values"], "u1").tobytes()
            offsets = self.view(stored["stringOffsets"], "<u4").tolist()
            return [text[a:b].decode() for a, b in itertools.pairwise(offsets)]
        values = self.view(stored["values"], COMPONENTS[kind["componentType"]]).tolist()
        return [None if "noData" in kind and value == kind["noData"] else value for value in values]


@given(segmentations(), st.booleans())
def test_every_corner_of_every_face_has_the_id_of_its_node(segmented: Segmented, all_levels: bool) -> None:
    mesh, hierarchy, segments = segmented
    glb = Glb(written("glb", mesh, hierarchy, segments, all_levels=all_levels, features=True))
    assert {"EXT_mesh_features", "EXT_structural_metadata"} <= set(glb.document["extensionsUsed"])
    drawn = hierarchy.segment_nodes(hierarchy.max_segments if all_levels else segments).tolist()
    for part in glb.document["nodes"]:
        if "mesh" in part:
            node = part["extras"]["node"]
            (primitive,) = glb.document["meshes"][part["mesh"]]["primitives"]
            (feature,) = primitive["extensions"]["EXT_mesh_features"]["featureIds"]
            assert feature["propertyTable"] == 0
            assert set(glb.feature_ids(primitive, feature).tolist()) == {node}
            assert drawn[part["mesh"]] == node


@given(segmentations(), st.booleans())
def test_the_property_table_is_the_whole_hierarchy(segmented: Segmented, all_levels: bool) -> None:
    mesh, hierarchy, segments = segmented
    glb = Glb(written("glb", mesh, hierarchy, segments, all_levels=all_levels, features=True))
    metadata = glb.document["extensions"]["EXT_structural_metadata"]
    (table,) = metadata["propertyTables"]
    kinds = metadata["schema"]["classes"][table["class"]]["properties"]
    columns = {name: glb.column(table, kind, name) for name, kind in kinds.items()}
    assert {len(column) for column in columns.values()} == {table["count"]} == {hierarchy.node_count}
    for i, entry in enumerate(node_documents(hierarchy)):
        assert {name: column[i] for name, column in columns.items() if name != "name"} == {
            name: entry[name] for name in columns if name != "name"
        }
    shown = {node["extras"]["node"]: node["name"] for node in glb.document["nodes"]}
    assert columns["name"] == [shown.get(i, f"node {i}") for i in range(hierarchy.node_count)]


@given(segmentations())
def test_features_change_nothing_else(segmented: Segmented) -> None:
    plain, rich = (Glb(written("glb", *segmented, features=features)) for features in (False, True))
    assert rich.document["nodes"] == plain.document["nodes"]
    for part, same in zip(plain.document["meshes"], rich.document["meshes"], strict=True):
        (primitive,), (richer,) = part["primitives"], same["primitives"]
        assert "_FEATURE_ID_0" not in primitive["attributes"]
        assert richer["attributes"].items() >= primitive["attributes"].items()
        assert rich.indices(richer).tolist() == plain.indices(primitive).tolist()
    length = plain.document["buffers"][0]["byteLength"]
    assert rich.binary[:length] == plain.binary[:length]


@given(looks())
def test_feature_ids_follow_the_rows_of_the_appearance(looking: tuple[Mesh, Hierarchy]) -> None:
    glb = Glb(written("glb", *looking, 3, features=True))
    for part in glb.document["nodes"]:
        if "mesh" in part:
            node = part["extras"]["node"]
            (primitive,) = glb.document["meshes"][part["mesh"]]["primitives"]
            (feature,) = primitive["extensions"]["EXT_mesh_features"]["featureIds"]
            assert set(glb.feature_ids(primitive, feature).tolist()) == {node}


@pytest.mark.parametrize("segments", [1, 3])
def test_parts_that_do_not_meet_share_an_attribute(segments: int) -> None:
    """The strips share no vertex, but the halves of one of them do: three parts need two layers."""
    glb = Glb(written("glb", *two_strips(), segments, features=True))
    layers = {mesh["primitives"][0]["attributes"]["_FEATURE_ID_0"] for mesh in glb.document["meshes"]}
    assert len(layers) == min(segments, 2)
