"""Segments as separate meshes: closed ones are solids, as far as the mesh allows."""

from collections import Counter

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.bodies.creatures import creature
from helpers.files.hierarchies import segmentations
from helpers.meshes import moved
from helpers.printing.solids import cup, fans, halves, lathe, pipe, volume
from segcore import shapes
from segcore.hierarchy import Hierarchy
from segcore.io.parts.pieces import Part, closed_parts, segment_parts
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters

Segmented = tuple[Mesh, Hierarchy, int]
CLOSED = {
    "ball": shapes.icosphere(2),
    "pipe": pipe(6),
    "cup": cup(6),
    "cube": trimesh.creation.box(),
}


def directed_edges(part: Part) -> Counter[tuple[int, int]]:
    return Counter((a, b) for face in part.faces.tolist() for a, b in zip(face, face[1:] + face[:1], strict=True))


def assert_solid(part: Part) -> None:
    """Each edge has two faces, in opposite directions, each vertex one fan of faces, and no face is there twice."""
    edges = directed_edges(part)
    assert set(edges.values()) == {1}
    assert all((b, a) in edges and a != b for a, b in edges)
    assert fans(part.faces) == len(part.vertices)
    assert part.is_solid


@pytest.mark.parametrize("segments", [1, 2, 7, 20, 64])
def test_closed_parts_are_solids(burr: tuple[Mesh, Hierarchy], segments: int) -> None:
    mesh, hierarchy = burr
    total = 0.0
    for part in closed_parts(mesh, hierarchy, segments):
        assert_solid(part)
        total += volume(part.vertices, part.faces)
    if segments <= 7:  # the arms are cut off along nearly plane loops, so that the two caps of a cut nearly coincide
        assert total == pytest.approx(volume(mesh.vertices, mesh.faces), rel=1e-2)


@pytest.mark.parametrize("missing", [0, 3])
def test_closed_parts_of_a_creature_are_solids_at_every_level(missing: int) -> None:
    mesh = creature(subdivisions=3, missing=missing)
    hierarchy = segment(mesh, SegmentationParameters(max_segments=30))
    for segments in range(1, hierarchy.max_segments + 1):
        parts = list(closed_parts(mesh, hierarchy, segments))
        assert len(parts) == segments
        for part in parts:
            assert_solid(part)


@given(shape=st.sampled_from(sorted(CLOSED)), seed=st.integers(0, 2**32 - 1), scattered=st.booleans())
@settings(max_examples=25, deadline=None)
def test_any_faces_of_a_closed_manifold_become_solids(shape: str, seed: int, scattered: bool) -> None:
    """Borders touch at vertices, parts have several pieces, and loops lie in one another."""
    mesh = Mesh(CLOSED[shape].vertices, CLOSED[shape].faces)
    rng = np.random.default_rng(seed)
    if scattered:
        in_first = rng.random(len(mesh.faces)) < rng.random()
    else:  # patches: the faces that are nearest to some of a few points
        points = rng.permutation(centres(mesh))[:8]
        nearest = np.linalg.norm(centres(mesh)[:, None] - points, axis=2).argmin(axis=1)
        in_first = np.isin(nearest, [0, 1, 2])
    in_first[0], in_first[-1] = True, False
    for part in closed_parts(mesh, halves(mesh, in_first), 2):
        assert_solid(part)


@given(segmentations())
def test_the_border_of_a_closed_part_of_any_mesh_is_empty(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    for part in closed_parts(mesh, hierarchy, segments):
        edges = directed_edges(part)
        assert all(count == edges[b, a] for (a, b), count in edges.items() if a != b)
        assert part.is_solid == (set(edges.values()) == {1})


def centres(mesh: Mesh) -> np.ndarray:
    return mesh.corners.mean(axis=1)


def cut_of(name: str) -> tuple[Mesh, np.ndarray]:
    """A mesh with a wall, and the faces on one side of a cut through the wall."""
    mesh = cup() if name.startswith("cup") else pipe(700) if name == "long loops" else pipe()
    x, y, z = centres(mesh).T
    radius = np.hypot(x, y)
    match name:
        case "pipe across" | "cup across":
            return mesh, z > 1.01
        case "pipe slanted":
            return mesh, z > 0.1 + 0.3 * x
        case "pipe in a step" | "long loops":
            return mesh, z > np.where(radius < 0.9, 0.5, 0.0)
        case "pipe along":
            return mesh, x > 0.02
        case _:
            return mesh, (x > 0.3) & (np.abs(z) < 1.01)


@pytest.mark.parametrize(
    "name",
    ["pipe across", "pipe slanted", "pipe in a step", "long loops", "pipe along", "pipe window", "cup across"],
)
def test_a_cut_through_a_wall_is_closed_along_the_wall_and_leaves_the_bore_open(name: str) -> None:
    mesh, in_first = cut_of(name)
    whole = volume(mesh.vertices, mesh.faces)
    parts = list(closed_parts(mesh, halves(mesh, in_first)))
    for part in parts:
        assert_solid(part)
    assert sum(volume(part.vertices, part.faces) for part in parts) == pytest.approx(whole, rel=2e-3)


def test_a_plate_keeps_its_thickness_between_the_hubs_that_are_cut_off() -> None:
    """The loops at both sides of a plate are near each other and opposite, but what lies between them is inside."""
    wheel = lathe([(0, -1), (0.4, -1), (0.4, -0.1), (2, -0.1), (2, 0.1), (0.4, 0.1), (0.4, 1), (0, 1)])
    in_plate = np.hypot(*centres(wheel)[:, :2].T) > 0.45
    plate, hubs = closed_parts(wheel, halves(wheel, in_plate))
    assert volume(plate.vertices, plate.faces) == pytest.approx(np.pi * 4 * 0.2, rel=2e-2)
    assert volume(hubs.vertices, hubs.faces) == pytest.approx(2 * np.pi * 0.16 * 0.9, rel=2e-1)


def test_the_outer_and_the_inner_half_of_a_ring_add_up_to_the_ring() -> None:
    ring = trimesh.creation.torus(2, 0.5, 48, 24)
    mesh = Mesh(ring.vertices, ring.faces)
    parts = list(closed_parts(mesh, halves(mesh, np.hypot(*centres(mesh)[:, :2].T) > 2)))
    assert sum(volume(part.vertices, part.faces) for part in parts) == pytest.approx(ring.volume, rel=1e-6)


def test_the_surface_of_a_hollow_alone_becomes_the_body_that_fills_it() -> None:
    mesh = cup()
    x, y, z = centres(mesh).T
    in_hollow = (np.hypot(x, y) < 0.92) & (z > 0.05)
    hollow, rest = closed_parts(mesh, halves(mesh, in_hollow))
    assert volume(hollow.vertices, hollow.faces) == pytest.approx(np.pi * 0.81 * 1.9, rel=2e-2)
    assert volume(rest.vertices, rest.faces) == pytest.approx(np.pi * 2, rel=2e-2)


def test_bodies_that_share_an_edge_or_a_corner_are_divided() -> None:
    cube = trimesh.creation.box()
    for shift in ((1, 1, 0), (1, 1, 1)):
        both = trimesh.util.concatenate([cube, cube.copy().apply_translation(shift)])
        mesh = Mesh(both.vertices, both.faces)
        (part,) = closed_parts(mesh, halves(mesh, np.arange(len(both.faces)) < 5), 1)
        assert_solid(part)
        assert len(part.vertices) == 16


def test_closed_parts_have_the_positions_of_the_file() -> None:
    mesh = moved(creature(subdivisions=3), (1e6, 0.1, -7e5))
    hierarchy = segment(mesh, SegmentationParameters(max_segments=8))
    given_positions = set(map(tuple, mesh.vertices.tolist()))
    parts = zip(closed_parts(mesh, hierarchy, 8), segment_parts(mesh, hierarchy, 8), strict=True)
    for part, opened in parts:
        np.testing.assert_array_equal(part.vertices[part.faces[: len(opened.faces)]], opened.vertices[opened.faces])
        assert given_positions.issuperset(map(tuple, opened.vertices.tolist()))
