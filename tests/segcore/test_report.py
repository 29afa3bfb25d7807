"""The counts of a mesh report agree with those of plain Python."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.meshes import exploded
from segcore import shapes
from segcore.clean.welding import WELD_TOLERANCE
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters, Structure
from segcore.report import StructureCounts, mesh_report, structure_note
from segcore.structure import FileStructure

BALL = shapes.icosphere(2)


def on_grid() -> st.SearchStrategy[Mesh]:
    """Meshes with many vertices at the same place and many faces at the same edge."""
    place = st.tuples(*[st.integers(0, 2)] * 3)
    vertices = st.lists(place, min_size=1, max_size=9)
    return vertices.flatmap(
        lambda points: st.lists(st.tuples(*[st.integers(0, len(points) - 1)] * 3), min_size=1, max_size=9).map(
            lambda faces: Mesh(np.array(points, dtype=float), faces)
        )
    )


@given(on_grid())
def test_counts_are_those_of_plain_python(mesh: Mesh) -> None:
    report = mesh_report(mesh)
    places = [tuple(corner) for corner in mesh.vertices.tolist()]
    faces = [tuple(places[corner] for corner in face) for face in mesh.faces.tolist()]
    proper = [face for face in faces if len(set(face)) == 3]
    distinct = {frozenset(face) for face in proper}
    edges = Counter(frozenset(edge) for face in distinct for edge in sides(tuple(face)))
    used = {corner for face in mesh.faces.tolist() for corner in face}
    assert report.degenerate_faces == len(faces) - len(proper)
    assert report.duplicate_faces == len(proper) - len(distinct)
    assert report.border_edges == sum(count == 1 for count in edges.values())
    assert report.non_manifold_edges == sum(count > 2 for count in edges.values())
    assert report.unused_vertices == len(places) - len(used)
    assert report.welded_vertices == len(used) - len({places[corner] for corner in used})
    assert report.is_closed == (bool(edges) and set(edges.values()) == {2})
    assert report.components == max(1, len(pieces(distinct))) or report.stitched_edges > 0


def sides(face: tuple) -> list[tuple]:
    return [(face[0], face[1]), (face[1], face[2]), (face[2], face[0])]


def pieces(faces: set[frozenset]) -> list[set[frozenset]]:
    """Sets of faces that are connected by edges."""
    found: list[set[frozenset]] = []
    for face in faces:
        joined = [piece for piece in found if any(len(face & other) == 2 for other in piece)]
        found = [piece for piece in found if piece not in joined] + [{face}.union(*joined)]
    return found


@given(st.sets(st.integers(0, len(BALL.faces) - 1), max_size=len(BALL.faces) // 2 - 1))
def test_flipped_faces_are_counted(turned: set[int]) -> None:
    faces = BALL.faces.copy()
    for face in turned:
        faces[face] = faces[face][::-1]
    report = mesh_report(Mesh(BALL.vertices, faces))
    assert report.flipped_faces == len(turned)
    assert report.volume == pytest.approx(mesh_report(BALL).volume)


def test_a_ball_that_is_inside_out_is_flipped_as_a_whole() -> None:
    report = mesh_report(Mesh(BALL.vertices, BALL.faces[:, ::-1]))
    assert report.flipped_faces == report.faces
    assert 4 < report.volume < 4 * np.pi / 3


def test_a_closed_ball_has_no_defects() -> None:
    report = mesh_report(Mesh(BALL.vertices * 10 + 5, BALL.faces))
    assert report.is_closed
    assert (report.components, report.border_edges, report.flipped_faces, report.sliver_faces) == (1, 0, 0, 0)
    assert report.area == pytest.approx(400 * np.pi, rel=0.05)
    np.testing.assert_allclose(report.lower, [-5] * 3, atol=0.5)
    np.testing.assert_allclose(report.upper, [15] * 3, atol=0.5)


def test_separate_corners_are_welded() -> None:
    report = mesh_report(exploded(BALL))
    assert report.welded_vertices == 3 * len(BALL.faces) - len(BALL.vertices)
    assert report.is_closed


def test_slivers_are_counted() -> None:
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [0.5, 1e-9, 0], [0.5, 1, 0]], [[0, 1, 2], [0, 1, 3]])
    assert mesh_report(mesh).sliver_faces == 1


def test_polygons_of_the_file_are_counted() -> None:
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], [0, 0])
    assert mesh_report(mesh).polygons == 1


def test_borders_that_were_rounded_differently_on_both_sides_are_joined() -> None:
    rng = np.random.default_rng(4)
    parts = exploded(BALL)
    noise = rng.uniform(-0.25, 0.25, parts.vertices.shape) * WELD_TOLERANCE
    for scale in (1e-3, 1.0, 1e6):
        report = mesh_report(Mesh((parts.vertices + noise) * scale, parts.faces))
        assert report.is_closed
        assert report.components == 1


def test_components_farther_apart_than_the_tolerance_stay_apart() -> None:
    gap = np.array([0, 0, 2 + 4 * WELD_TOLERANCE])
    two = Mesh(
        np.vstack([BALL.vertices, BALL.vertices + gap]), np.vstack([BALL.faces, BALL.faces + len(BALL.vertices)])
    )
    assert mesh_report(two).components == 2


def test_the_structure_is_counted_by_the_values_of_the_parameter() -> None:
    shape = shapes.joined(shapes.box(), shapes.box(centre=(3, 0, 0)), shapes.box(centre=(6, 0, 0)))
    group = np.array([4, 4, -1], np.int32)[shape.parts]
    mesh = Mesh(shape.mesh.vertices, shape.mesh.faces, structure=FileStructure(group=group))
    counts = mesh_report(mesh).structure
    assert counts == StructureCounts(shells=3, groups=2, materials=0)
    assert counts.has_parts
    assert counts.in_words() == "3 shells, 2 groups"
    assert not StructureCounts(1, 0, 1).has_parts
    assert StructureCounts(1, 0, 1).in_words() == "1 shell, 1 material"


@pytest.mark.parametrize("structure", ["shells", "groups", "materials"])
def test_the_count_is_the_automatic_number_of_a_segmentation_that_follows_it(structure: Structure) -> None:
    """Also if a group consists of faces that other faces represent."""
    shape = shapes.joined(shapes.box(), shapes.box(), shapes.box(centre=(3, 0, 0)), shapes.box(centre=(6, 0, 0)))
    file = FileStructure(shape.parts, np.minimum(shape.parts, 2))
    mesh = Mesh(shape.mesh.vertices, shape.mesh.faces, structure=file)
    hierarchy = segment(mesh, SegmentationParameters(structure=structure))
    assert hierarchy.automatic_segments == mesh_report(mesh).structure.named()[structure]


def test_a_note_says_how_the_structure_limits_the_hierarchy() -> None:
    counts = StructureCounts(shells=12_000, groups=64, materials=1)
    assert structure_note(counts, "none", 8) is None
    assert structure_note(counts, "groups", 65) is None
    assert "ends with the 64 groups of the file: choose max_segments above 64" in structure_note(counts, "groups", 64)
    assert structure_note(counts, "shells", 64).startswith("The file has 12000 shells: the 10000 largest are segments")
    assert structure_note(counts, "materials", 64).endswith("structure=materials has no effect.")


def test_stitched_edges_are_counted_and_their_gap_is_in_units_of_the_mesh() -> None:
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [1.0005, 0, 0], [2, 0, 0], [1.0005, 1, 0]])
    for scale in (1e-3, 1.0, 1e6):
        report = mesh_report(Mesh(vertices * scale, [[0, 1, 2], [3, 4, 5]]))
        assert (report.stitched_edges, report.components, report.border_edges) == (2, 1, 6)
        assert report.stitched_gap == pytest.approx(0.0005 * scale)
