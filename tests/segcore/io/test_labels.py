"""Labels and the hierarchy as text and as JSON."""

import io
import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from helpers.files.hierarchies import segmentations, two_strips
from helpers.files.written import json_of, labels_of_runs, written
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io.labels import hierarchy_document, labels_document, write_seg
from segcore.mesh import Mesh


def test_a_seg_file_has_one_label_on_each_line_in_the_order_of_the_faces() -> None:
    target = io.BytesIO()
    write_seg(target, np.array([0, 12, 3, 0], dtype=np.int32))
    assert target.getvalue() == b"0\n12\n3\n0\n"


@given(segmentations())
def test_the_labels_document_is_json_with_one_label_for_each_face(segmented: tuple[Mesh, Hierarchy, int]) -> None:
    mesh, hierarchy, segments = segmented
    document = json.loads(json.dumps(labels_document(hierarchy, segments), allow_nan=False))
    assert document == {"segments": segments, "labels": hierarchy.labels(segments).tolist()}
    assert len(document["labels"]) == len(mesh.faces)
    assert set(document["labels"]) == set(range(segments))


def test_no_number_of_segments_means_the_automatic_one() -> None:
    _, hierarchy = two_strips()
    assert labels_document(hierarchy) == labels_document(hierarchy, 2)
    with pytest.raises(InvalidParameters, match="1 to 3"):
        labels_document(hierarchy, 4)


@given(segmentations())
def test_labels_at_every_level_follow_from_the_hierarchy_document(segmented: tuple[Mesh, Hierarchy, int]) -> None:
    """A client can compute them: the segments of a level are the nodes of the level without children in it."""
    _, hierarchy, segments = segmented
    document = json.loads(json.dumps(hierarchy_document(hierarchy), allow_nan=False))
    nodes = document["nodes"]
    present = [node for node in nodes if node["level"] <= segments]
    leaves = [node for node in present if all(nodes[child]["level"] > segments for child in node["children"])]
    assert sorted(node["label"] for node in leaves) == list(range(segments))
    faces = np.bincount(hierarchy.labels(segments), minlength=segments)
    assert all(node["faces"] == faces[node["label"]] for node in leaves)


@given(segmentations())
def test_the_hierarchy_document_is_one_tree(segmented: tuple[Mesh, Hierarchy, int]) -> None:
    _, hierarchy, _ = segmented
    document = hierarchy_document(hierarchy)
    nodes = document["nodes"]
    assert [node["id"] for node in nodes] == list(range(2 * document["max_segments"] - 1))
    assert nodes[0]["parent"] is None
    for node in nodes:
        assert all(nodes[child]["parent"] == node["id"] for child in node["children"])
        assert sum(nodes[child]["faces"] for child in node["children"]) in (0, node["faces"])
        if node["children"]:
            assert node["cut_value"] == document["cut_values"][nodes[node["children"][0]]["level"] - 2]
        else:
            assert node["cut_value"] is None


def node(number: int, parent: int | None, children: list[int], **facts: float | None) -> dict[str, Any]:
    return {"id": number, "parent": parent, "children": children, "nary_children": children, **facts}


def test_nodes_of_one_step_have_their_children_in_common() -> None:
    _, hierarchy = two_strips()
    document = hierarchy_document(replace(hierarchy, step=np.zeros(2, dtype=np.int32), limit_reached=True))
    assert [entry["nary_children"] for entry in document["nodes"]] == [[1, 3, 4], [], [], [], []]
    assert [entry["children"] for entry in document["nodes"]] == [[1, 2], [], [3, 4], [], []]
    assert (document["steps"], document["step_ends"], document["limit_reached"]) == ([0, 0], [1, 3], True)


def test_the_hierarchy_document_of_a_small_tree() -> None:
    _, hierarchy = two_strips()
    assert hierarchy_document(hierarchy) == {
        "max_segments": 3,
        "automatic_segments": 2,
        "limit_reached": None,
        "steps": [0, 1],
        "step_ends": [1, 2, 3],
        "cut_values": [0.0, 1.5],
        "nodes": [
            node(0, None, [1, 2], level=1, label=0, area=2.0, faces=4, cut_value=0.0, step=0),
            node(1, 0, [], level=2, label=0, area=1.0, faces=2, cut_value=None, step=None),
            node(2, 0, [3, 4], level=2, label=1, area=1.0, faces=2, cut_value=1.5, step=1),
            node(3, 2, [], level=3, label=1, area=0.5, faces=1, cut_value=None, step=None),
            node(4, 2, [], level=3, label=2, area=0.5, faces=1, cut_value=None, step=None),
        ],
    }


@given(segmentations())
def test_seg_npy_and_json_hold_the_labels(segmented: tuple[Mesh, Hierarchy, int]) -> None:
    _, hierarchy, segments = segmented
    labels = hierarchy.labels(segments).tolist()
    assert [int(line) for line in written("seg", *segmented).split()] == labels
    array = np.load(io.BytesIO(written("npy", *segmented)), allow_pickle=False)
    assert (array.dtype, array.tolist()) == (np.int32, labels)
    document = json_of(written("json", *segmented))
    assert labels_of_runs(document) == labels
    assert document["segments"] == segments
    assert 0 not in document["lengths"]
    assert all(a != b for a, b in zip(document["values"], document["values"][1:], strict=False))
    assert document["hierarchy"] == hierarchy_document(hierarchy)
