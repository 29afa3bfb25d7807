"""Any labels of faces as parts, and as a hierarchy of one step."""

import json

import numpy as np
import pytest

from segcore.errors import InvalidMesh, InvalidParameters
from segcore.io import hierarchy_document
from segcore.io.edited.partition_file import decode_partition, encode_partition
from segcore.mesh import face_normals_and_areas
from segcore.partition import MOST_PARTS, Part, Partition, partition_of
from segcore.shapes import icosphere


@pytest.mark.parametrize("count", [1, 2, 3, 7])
def test_the_hierarchy_of_a_partition_has_its_labels_areas_and_counts(count: int) -> None:
    mesh = icosphere(2)
    labels = np.random.default_rng(count).permutation(np.arange(len(mesh.faces)) % count).astype(np.int32)
    hierarchy = Partition(labels).hierarchy(mesh)
    assert (hierarchy.labels() == labels).all()
    assert hierarchy.automatic_segments == hierarchy.max_segments == count
    nodes, areas = hierarchy.segment_nodes(), face_normals_and_areas(mesh.corners)[1]
    assert hierarchy.face_count[nodes].tolist() == np.bincount(labels).tolist()
    assert hierarchy.area[nodes] == pytest.approx(np.bincount(labels, areas))
    assert hierarchy.area[0] == pytest.approx(areas.sum())
    for split, node in enumerate(hierarchy.split_node.tolist()):
        halves = [2 * split + 1, 2 * split + 2]
        assert hierarchy.face_count[node] == hierarchy.face_count[halves].sum()
        assert hierarchy.area[node] == pytest.approx(hierarchy.area[halves].sum())


def test_the_parts_are_the_children_of_the_root() -> None:
    mesh = icosphere(1)
    hierarchy = Partition((np.arange(len(mesh.faces)) % 5).astype(np.int32)).hierarchy(mesh)
    assert sorted(hierarchy.nary_children[0]) == sorted(hierarchy.segment_nodes().tolist())
    assert json.dumps(hierarchy_document(hierarchy), allow_nan=False)


def test_labels_made_elsewhere_are_numbered_in_their_order() -> None:
    partition, given = partition_of([7, 2, 7, 40], 4)
    assert (partition.labels.tolist(), given) == ([1, 0, 1, 2], [2, 7, 40])


@pytest.mark.parametrize(
    ("labels", "sentence"),
    [
        ([0, 1], "There must be a label for each of the 3 faces of the file, not 2."),
        ([[0, 1, 2]], r"an array of shape \(1, 3\)"),
        ([0, -1, 1], "Labels are numbers from 0 to 999999: face 1 has -1."),
        ([0, 1, 2**40], "face 2 has 1099511627776"),
        ([0.0, 1.5, 1.0], "Labels are integers, not float64."),
    ],
)
def test_labels_that_are_none_are_refused(labels: object, sentence: str) -> None:
    with pytest.raises(InvalidParameters, match=sentence):
        partition_of(labels, 3)  # type: ignore[arg-type]


def test_too_many_parts_are_refused() -> None:
    with pytest.raises(InvalidParameters, match="at most 10000 parts"):
        partition_of(np.arange(MOST_PARTS + 1), MOST_PARTS + 1)


@pytest.mark.parametrize("labels", [[0, 2], [-1, 0], [1, 1]])
def test_a_part_has_faces_and_a_label_a_part(labels: list[int]) -> None:
    with pytest.raises(InvalidParameters, match="must be the numbers"):
        Partition(np.array(labels, dtype=np.int32))


def test_classes_are_numbered_from_1_in_the_order_of_a_list() -> None:
    parts = (Part(class_name="leg"), Part(), Part(class_name="arm"))
    partition = Partition(np.array([0, 1, 2, 0], dtype=np.int32), parts)
    assert partition.class_names == ["arm", "leg"]
    assert partition.class_labels(["arm", "leg"]).tolist() == [2, 0, 1, 2]
    assert partition.class_labels(["head", "leg", "arm"]).tolist() == [2, 0, 3, 2]
    with pytest.raises(InvalidParameters, match="'arm', which is not in the list"):
        partition.class_labels(["leg"])


def test_parts_are_the_same_after_they_were_bytes_and_damage_is_found() -> None:
    parts = (Part("Bein", "#aabbcc", "leg", locked=True), Part())
    data = encode_partition(Partition(np.array([0, 1, 1], dtype=np.int32), parts))
    again = decode_partition(data)
    assert (again.labels.tolist(), again.parts) == ([0, 1, 1], parts)
    for wrong in (
        b"",
        data[:-1],
        data[:20],
        data.replace(b"#aabbcc", b"#aabbcz"),
        data.replace(b'"faces":3', b'"faces":4'),
    ):
        with pytest.raises(InvalidMesh, match="damaged"):
            decode_partition(wrong)
