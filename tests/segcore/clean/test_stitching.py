"""Patches that meet are one surface; borders that only pass each other stay open."""

import numpy as np
import pytest

from helpers.patches import flat_patches, patched, patches_around, sheet, tube
from segcore import segment, shapes
from segcore.clean.stitching import stitch
from segcore.clean.surface import build_surface
from segcore.clean.topology import dual_edges
from segcore.graphs.surface_graph import connected_components
from segcore.mesh import Mesh

BURR = shapes.burr(subdivisions=4)
DUMBBELL = shapes.dumbbell(rings=60, around=32)
NOTCHED = Mesh(  # the prism over an L
    [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2))],
    [(0, 3, 1), (1, 3, 2), (0, 4, 3), (0, 5, 4), (6, 7, 9), (7, 8, 9), (6, 9, 10), (6, 10, 11)]
    + [face for i in range(6) for j in [(i + 1) % 6] for face in ((i, j, 6 + j), (i, 6 + j, 6 + i))],
)
SOLIDS = {
    "box": shapes.box((2, 1, 0.5)),
    "prism": NOTCHED,
    "cylinder": shapes.revolve(np.array([0.5, 0.5]), np.array([-1.0, 1.0]), 24),
    "ball": shapes.icosphere(2),
}


def components(mesh: Mesh) -> int:
    surface = build_surface(mesh)
    return int(connected_components(surface.edge_faces, len(surface.faces)).max()) + 1


def adjusted_rand(labels: np.ndarray, truth: np.ndarray) -> float:
    table = np.zeros((labels.max() + 1, truth.max() + 1))
    np.add.at(table, (labels, truth), 1)
    both, one, other, every = (
        float((n * (n - 1) / 2).sum()) for n in (table, table.sum(0), table.sum(1), table.sum(keepdims=True))
    )
    return (both - one * other / every) / ((one + other) / 2 - one * other / every)


@pytest.mark.parametrize("levels", [(0,), (0, 1, 2, 3)], ids=["cracks", "T-junctions"])
@pytest.mark.parametrize("gap", [0, 1e-5, 3e-4, 1e-3])
@pytest.mark.parametrize("name", SOLIDS)
def test_a_solid_of_patches_is_one_surface_that_faces_outward(name: str, gap: float, levels: tuple[int, ...]) -> None:
    rng = np.random.default_rng(3)
    solid = SOLIDS[name]
    patch = patches_around(solid, 12, rng) if name == "ball" else flat_patches(solid)
    cut = patched(solid, patch, gap, rng, levels, turn=True)
    surface = build_surface(cut.mesh)
    assert connected_components(surface.edge_faces, len(surface.faces)).max() == 0
    outward = np.cross(*np.diff(solid.corners, axis=1).transpose(1, 0, 2))[cut.source]
    assert (np.einsum("ij,ij->i", surface.normals[surface.face_of_input], outward) > 0).all()


@pytest.mark.parametrize(
    ("shape", "patches", "levels", "gap"),
    [
        (BURR, 40, (0,), 1e-4),
        (BURR, 20, (0, 1), 0.0),
        (DUMBBELL, 12, (0,), 1e-3),
        (DUMBBELL, 60, (0, 1), 3e-4),
    ],
)
def test_a_shape_of_patches_has_the_parts_of_the_closed_shape(
    shape: shapes.Shape, patches: int, levels: tuple[int, ...], gap: float
) -> None:
    rng = np.random.default_rng(5)
    cut = patched(shape.mesh, patches_around(shape.mesh, patches, rng), gap, rng, levels, turn=True)
    assert adjusted_rand(segment(cut.mesh).labels(), shape.parts[cut.source]) > 0.85


def test_gaps_may_differ_along_a_mesh() -> None:
    rng = np.random.default_rng(2)
    patch = patches_around(BURR.mesh, 30, rng)
    own = patched(BURR.mesh, patch, 0.0, rng).mesh
    of_vertex = np.zeros(len(own.vertices), dtype=int)
    of_vertex[own.faces] = np.sort(patch)[:, None]
    gap = 10 ** rng.uniform(-6, -3, 30)[of_vertex, None] * np.ptp(own.vertices, axis=0).max()
    assert components(Mesh(own.vertices + gap * rng.uniform(-1, 1, own.vertices.shape), own.faces)) == 1


def test_half_pipes_that_face_each_other_wrongly_are_joined_into_a_pipe() -> None:
    flat = sheet([0, 0, 0], [0.5, 0, 0], [0, 1, 0], (16, 5))
    angle = 2 * np.pi * flat.vertices[:, 0]
    half = np.stack([np.cos(angle), np.sin(angle), 3 * flat.vertices[:, 1]], axis=1)
    other = half * [-1, -1, 1] + [0, 1e-4, 0]
    surface = build_surface(shapes.joined(Mesh(half, flat.faces), Mesh(other, flat.faces[:, ::-1])).mesh)
    assert connected_components(surface.edge_faces, len(surface.faces)).max() == 0
    outward = np.einsum("ij,ij->i", surface.normals, surface.vertices[surface.faces].mean(axis=1) * [1, 1, 0])
    assert (outward > 0).all() or (outward < 0).all()


def test_every_triangle_may_be_a_patch() -> None:
    ball = shapes.icosphere(3)
    cut = patched(ball, np.arange(len(ball.faces), dtype=np.int32), 1e-3, np.random.default_rng(1), turn=True)
    assert components(cut.mesh) == 1


def test_matching_vertices_become_one_and_the_input_keeps_its_faces() -> None:
    ball = shapes.icosphere(2)
    cut = patched(ball, patches_around(ball, 9, np.random.default_rng(0)), 1e-4, np.random.default_rng(0))
    surface = build_surface(cut.mesh)
    assert len(surface.vertices) == len(ball.vertices)
    assert len(surface.edge_faces) == 3 * len(ball.faces) // 2
    np.testing.assert_array_equal(surface.face_of_input, np.arange(len(ball.faces)))
    assert 0 < surface.stitched_gap < 4e-4


def test_a_t_junction_has_a_dual_edge_for_every_interval() -> None:
    """A long edge opposite three short ones: the intervals have the lengths of the short ones."""
    upper, lower = sheet([0, 0, 0], [3, 0, 0], [0, 1, 0], (1, 1)), sheet([0, -1, 0], [3, 0, 0], [0, 1, 0], (3, 1))
    surface = build_surface(shapes.joined(upper, lower).mesh)
    across = (surface.edge_faces < 2).any(axis=1) & (surface.edge_faces >= 2).any(axis=1)
    ends = surface.vertices[surface.edge_vertices[across]]
    assert surface.stitched_edges == 4
    np.testing.assert_allclose(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1), [1 / 3] * 3)


@pytest.mark.parametrize("faces", [320, 300], ids=["closed", "with a hole"])
def test_a_surface_without_matches_is_returned_as_it_is(faces: int) -> None:
    ball = shapes.icosphere(2)
    dual = dual_edges(ball.faces[:faces], len(ball.vertices))
    vertices, kept = ball.vertices / 2, ball.faces[:faces]
    joined = stitch(vertices, kept, dual)
    assert joined.vertices is vertices
    assert joined.faces is kept
    assert joined.dual is dual
    assert (joined.edges, joined.gap) == (0, 0.0)


APART = {
    "two sides of a plate": (
        sheet([0, 0, 0], [1, 0, 0], [0, 1, 0], (7, 7)),
        sheet([0, 0, 1e-3], [0, 1, 0], [1, 0, 0], (6, 6)),
    ),
    "layers of cloth": (
        sheet([0, 0, 0], [1, 0, 0], [0, 1, 0], (9, 9)),
        sheet([5e-4, 5e-4, 5e-4], [1, 0, 0], [0, 1, 0], (9, 9)),
    ),
    "a sharp wing": (
        sheet([0, 0, 2e-4], [1, 0, 0], [0, 1, 0.1], (9, 9)),
        sheet([0, 0, -2e-4], [0, 1, -0.1], [1, 0, 0], (7, 7)),
    ),
    "the walls of a cup": (tube(1.0, 0.0, 2.0, 40), tube(0.998, 0.0, 2.0, 36)),
    "a tin and its lid": (tube(1.0, 0.0, 2.0, 40), tube(1.0, 2.02, 2.3, 40)),
    "a sleeve around an arm": (tube(1.0, 0.0, 2.0, 40), tube(0.98, 1.98, 4.0, 40)),
    "open boxes side by side": (
        sheet([0, 0, 0], [0, 1, 0], [0, 0, 1], (4, 4)),
        sheet([1e-3, 0, 0], [0, 1, 0], [0, 0, 1], (5, 5)),
    ),
    "cards that cross": (
        sheet([0, 0, 0], [1, 0, 0], [0, 0.2, 0], (8, 1)),
        sheet([0, -0.1, 0], [1, 0.2, 0], [0, -0.2, 0.1], (8, 1)),
    ),
    "sheets that diverge": (
        sheet([0, 0, 0], [1, 0, 0], [0, 1, 0], (20, 2)),
        sheet([0, -1e-3, 0], [1, -0.02, 0], [0, -1, 0], (20, 2)),
    ),
}


@pytest.mark.parametrize("name", APART)
def test_what_only_passes_stays_apart(name: str) -> None:
    assert build_surface(shapes.joined(*APART[name]).mesh).stitched_edges == 0


def test_a_strip_narrower_than_the_tolerance_is_not_joined_to_itself() -> None:
    strip = sheet([0, 0, 0], [1, 0, 0], [0, 1e-3, 0], (30, 1))
    assert build_surface(strip).stitched_edges == 0


def test_of_three_sheets_at_a_line_the_two_that_continue_each_other_are_joined() -> None:
    """The third one stands on their common border and keeps its border."""
    left, right = sheet([0, 0, 0], [1, 0, 0], [0, 1, 0], (5, 2)), sheet([0, -1, 0], [1, 0, 0], [0, 1, 0], (6, 2))
    surface = build_surface(shapes.joined(left, right, sheet([0, 0, 0], [1, 0, 0], [0, 0, 1], (7, 2))).mesh)
    component = connected_components(surface.edge_faces, len(surface.faces))
    assert component[0] == component[len(left.faces)] != component[-1]
