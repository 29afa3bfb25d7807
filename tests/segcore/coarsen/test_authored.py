"""The authored structure: its parts come first, and no cluster, link or border crosses them."""

import numpy as np
import pytest

from helpers.meshes import pieces_of_labels
from segcore import shapes
from segcore.clean.surface import build_surface
from segcore.coarsen import authored
from segcore.coarsen.authored import authored_parts, group_by_part, largest_of_each_part, with_structure
from segcore.coarsen.components import group_by_nearness
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters
from segcore.shapes import Shape, box, joined
from segcore.structure import FileStructure

BURR = shapes.burr(4)


def with_groups(mesh: Mesh, group: np.ndarray) -> Mesh:
    return Mesh(mesh.vertices, mesh.faces, structure=FileStructure(group=group.astype(np.int32)))


def row_of_boxes(count: int) -> Shape:
    return joined(*[box((1, 1, 1), (1.5 * i, 0, 0)) for i in range(count)])


def same_partition(one: np.ndarray, other: np.ndarray) -> bool:
    pairs = len(set(zip(one.tolist(), other.tolist(), strict=True)))
    return pairs == len(set(one.tolist())) == len(set(other.tolist()))


def followed(mesh: Mesh, structure: str, **others: object) -> Hierarchy:
    return segment(mesh, SegmentationParameters.from_mapping({"structure": structure, **others}))


@pytest.mark.parametrize("preset", [{}, {"affinity": "concavity"}, {"preset": "chahhou2014"}])
def test_the_automatic_parts_are_the_groups_of_the_file(preset: dict[str, object]) -> None:
    """The groups are welded to each other, one of them is the faces without a group."""
    hierarchy = followed(with_groups(BURR.mesh, BURR.parts - 1), "groups", max_segments=16, **preset)
    assert hierarchy.automatic_segments == 7
    assert same_partition(hierarchy.labels(), BURR.parts)
    assert (hierarchy.cut_value[:6] == 0).all()
    assert (hierarchy.cut_value[6:] > 0).all()
    assert hierarchy.max_segments == 16


def test_groups_in_any_place_are_kept_exactly() -> None:
    """Borders of groups that follow no concavity, with a group of several pieces."""
    height = BURR.mesh.corners[:, :, 2].mean(axis=1)
    bands = np.floor(4 * (height + 3)).astype(int) % 3
    hierarchy = followed(with_groups(BURR.mesh, bands), "groups")
    assert hierarchy.automatic_segments == 3
    assert same_partition(hierarchy.labels(), bands)
    pieces = pieces_of_labels(BURR.mesh, bands)
    assert pieces > 3
    for k in (4, 12, hierarchy.max_segments):
        finer = hierarchy.labels(k)
        assert len(set(zip(finer.tolist(), bands.tolist(), strict=True))) == k


def test_touching_shells_come_first_and_are_cut_below() -> None:
    ball = shapes.icosphere(3)
    shape = joined(BURR.mesh, Mesh(0.5 * ball.vertices + [0, 0, 2.9], ball.faces), box((1, 1, 1), (0, 0, -3)))
    hierarchy = followed(shape.mesh, "shells")
    assert hierarchy.automatic_segments == 3
    assert same_partition(hierarchy.labels(), shape.parts)
    assert len(set(hierarchy.labels(9)[shape.parts == 0])) == 7
    assert segment(shape.mesh).automatic_segments > 3


def test_a_group_of_touching_and_distant_components_is_one_node() -> None:
    """Two boxes that touch and a distant one are a group; the box between is another."""
    shape = joined(*[box((1, 1, 1), (x, 0, 0)) for x in (0, 1, 4, 9)])
    group = np.array([0, 0, 1, 0])[shape.parts]
    hierarchy = followed(with_groups(shape.mesh, group), "groups")
    assert hierarchy.automatic_segments == 2
    assert same_partition(hierarchy.labels(), group)
    assert hierarchy.cut_value[:2].tolist() == [0, 0]
    assert same_partition(hierarchy.labels(3), np.array([0, 0, 1, 2])[shape.parts])


def test_there_are_as_many_segments_as_shells_even_beyond_the_limit() -> None:
    shape = row_of_boxes(80)
    hierarchy = followed(shape.mesh, "shells", max_segments=8)
    assert (hierarchy.automatic_segments, hierarchy.max_segments) == (80, 80)
    assert same_partition(hierarchy.labels(), shape.parts)


def test_more_shells_than_clusters_and_than_samples_are_all_separated() -> None:
    shape = row_of_boxes(2500)
    hierarchy = followed(shape.mesh, "shells")
    assert hierarchy.automatic_segments == 2500
    assert same_partition(hierarchy.labels(), shape.parts)


def test_parts_beyond_the_most_are_merged_with_the_nearest_of_the_largest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(authored, "MOST_AUTHORED", 2)
    sizes, places = (1, 2, 1, 2, 1), (0, 3, 6, 20, 23)
    shape = joined(*[box((size, 1, 1), (x, 0, 0)) for size, x in zip(sizes, places, strict=True)])
    hierarchy = followed(shape.mesh, "shells")
    assert hierarchy.automatic_segments == 2
    assert same_partition(hierarchy.labels(), np.array([0, 0, 0, 1, 1])[shape.parts])


@pytest.mark.parametrize("structure", ["groups", "materials"])
def test_a_file_without_the_structure_is_refused_with_a_remedy(structure: str) -> None:
    with pytest.raises(InvalidParameters, match=f"no {structure}: use structure=shells"):
        followed(box(), structure)


def test_a_structure_of_one_part_changes_nothing() -> None:
    plain = segment(BURR.mesh)
    for mesh, structure in ((BURR.mesh, "shells"), (with_groups(BURR.mesh, 3 * np.ones(len(BURR.parts))), "groups")):
        same = followed(mesh, structure)
        assert same.automatic_segments == plain.automatic_segments
        assert same.face_leaf.tobytes() == plain.face_leaf.tobytes()


def test_repeated_and_degenerate_faces_are_in_the_part_of_the_face_that_represents_them() -> None:
    """The first face of the file is degenerate and in another group than the face at its edge."""
    square = [[0, 0, 1], [0, 1, 2], [0, 2, 3], [2, 1, 0]]
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], square)
    mesh = with_groups(mesh, np.array([5, 6, 7, 5]))
    parts = authored_parts(build_surface(mesh), mesh, "groups")
    assert parts.tolist() == [0, 1]
    labels = followed(mesh, "groups").labels()
    assert labels[0] == labels[1] == labels[3] != labels[2]


def test_a_surface_has_no_dual_edge_between_parts() -> None:
    mesh = with_groups(BURR.mesh, BURR.parts)
    before = build_surface(mesh)
    after = with_structure(before, mesh, "groups")
    crossing = BURR.parts[before.edge_faces[:, 0]] != BURR.parts[before.edge_faces[:, 1]]
    np.testing.assert_array_equal(after.edge_faces, before.edge_faces[~crossing])
    np.testing.assert_array_equal(after.edge_vertices, before.edge_vertices[~crossing])
    assert same_partition(after.authored, BURR.parts)


def test_without_a_structure_the_surface_is_the_same_object() -> None:
    surface = build_surface(BURR.mesh)
    assert with_structure(surface, BURR.mesh, "none") is surface


def test_parts_are_grouped_after_the_components_of_each() -> None:
    """Components 0 and 3 are part 1, although 1 is nearer to 0; component 1 and 2 are parts 0 and 2."""
    points = np.array([[0.0, 0, 0], [0.1, 0, 0], [0.5, 0, 0], [0.9, 0, 0]])
    merges = group_by_part(points, np.array([0, 1, 2, 3]), np.array([1, 0, 2, 1]))
    np.testing.assert_array_equal(np.sort(merges, axis=1), [[0, 3], [1, 4], [2, 5]])
    np.testing.assert_array_equal(
        group_by_part(points, np.array([0, 1, 2, 3]), None), group_by_nearness(points, np.array([0, 1, 2, 3]))
    )


def test_every_part_has_its_largest_component() -> None:
    component, areas = np.array([0, 1, 2, 2, 3]), np.array([1.0, 2.0, 1.5, 1.5, 9.0])
    part = np.array([0, 0, 1, 1, 1])
    np.testing.assert_array_equal(largest_of_each_part(component, areas, part), [False, True, False, True])
    assert not largest_of_each_part(component, areas, None).any()
