"""Solids that touch along whole faces are parts of their own; other repeated faces are left out."""

import manifold3d
import numpy as np
import pytest

from helpers.bodies.plates import mesh_of
from segcore import shapes
from segcore.clean.solids import with_solids_apart
from segcore.clean.surface import build_surface
from segcore.graphs.surface_graph import connected_components
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.report import mesh_report

BRICK = (1.0, 0.5, 0.3)
PLACES = {
    "stack": [(0, 0, 0.3 * i) for i in range(4)],
    "row": [(i, 0, 0) for i in range(3)],
    "wall": [(x, 0, 0.3 * z) for x in range(3) for z in range(3)],
    "block": [(x, 0.5 * y, 0.3 * z) for x in range(3) for y in range(3) for z in range(3)],
}


def soup(*meshes: Mesh) -> Mesh:
    """Triangles with corners of their own in single precision, as in an STL file."""
    corners = np.concatenate([mesh.corners for mesh in meshes]).astype(np.float32).astype(np.float64)
    return Mesh(corners.reshape(-1, 3), np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3))


def bricks(name: str) -> tuple[Mesh, np.ndarray]:
    boxes = [shapes.box(BRICK, place) for place in PLACES[name]]
    return soup(*boxes), np.repeat(np.arange(len(boxes)), [len(box.faces) for box in boxes])


def bodies(mesh: Mesh) -> np.ndarray:
    """(F,) the component that every input face lies in."""
    surface = build_surface(mesh)
    return connected_components(surface.edge_faces, len(surface.faces))[surface.face_of_input]


def inside_out(mesh: Mesh) -> Mesh:
    return Mesh(mesh.vertices, mesh.faces[:, ::-1].copy())


@pytest.mark.parametrize("name", PLACES)
def test_bricks_of_one_size_are_bodies(name: str) -> None:
    mesh, brick = bricks(name)
    body = bodies(mesh)
    assert body.max() == brick.max()
    np.testing.assert_array_equal(body, body[np.searchsorted(brick, brick)])


def test_the_order_of_the_faces_makes_no_difference() -> None:
    mesh, brick = bricks("wall")
    order = np.random.default_rng(0).permutation(len(brick))
    body = bodies(Mesh(mesh.vertices, mesh.faces[order]))
    assert len({tuple(pair) for pair in zip(body, brick[order], strict=True)}) == brick.max() + 1


@pytest.mark.parametrize("name", ["stack", "wall"])
def test_bricks_of_one_size_are_parts(name: str) -> None:
    mesh, brick = bricks(name)
    labels = segment(mesh).labels()
    assert len({tuple(pair) for pair in zip(labels, brick, strict=True)}) == labels.max() + 1 == brick.max() + 1


def test_a_pin_that_fills_its_hole_is_a_body() -> None:
    pin = manifold3d.Manifold.cylinder(0.3, 0.3, 0.3, 32, center=True)
    plate = manifold3d.Manifold.cube((2, 2, 0.3), center=True) - pin
    meshes = [mesh_of(plate), mesh_of(pin)]
    body = bodies(soup(*meshes))
    faces = len(meshes[0].faces)
    assert set(body[:faces]) == {0}
    assert set(body[faces:]) == {1}


def test_faces_of_both_sides_of_a_sheet_are_one() -> None:
    x, y = np.meshgrid(np.arange(4.0), np.arange(4.0))
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(16)], axis=1)
    quads = [(i, i + 1, i + 5, i + 4) for i in range(11) if i % 4 != 3]
    front = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.int32)
    surface = build_surface(Mesh(vertices, np.concatenate([front, front[:, ::-1]])))
    assert len(surface.faces) == len(front)


def test_a_body_that_was_modelled_from_inside_as_well_is_one() -> None:
    box = shapes.box(BRICK)
    surface = build_surface(soup(box, inside_out(box)))
    assert len(surface.faces) == len(box.faces)
    assert mesh_report(soup(box, inside_out(box))).duplicate_faces == len(box.faces)


def test_repeated_solids_are_one() -> None:
    box = shapes.box(BRICK)
    assert len(build_surface(soup(box, box)).faces) == len(box.faces)


def test_the_cubes_of_a_voxel_model_stay_together() -> None:
    cubes = [shapes.box((1, 1, 1), (x, y, z)) for x in range(3) for y in range(2) for z in range(2)]
    assert bodies(soup(*cubes)).max() == 0


def test_an_open_box_is_no_solid() -> None:
    """Without its lid, the face between it and the box on it is a repeated one, as before."""
    lower, upper = shapes.box(BRICK), shapes.box(BRICK, (0, 0, 0.3))
    floor = np.abs(lower.corners[:, :, 2] - lower.vertices[:, 2].min()).max(axis=1) < 1e-9
    mesh = soup(Mesh(lower.vertices, lower.faces[~floor]), upper)
    assert bodies(mesh).max() == 0


def test_a_mesh_without_repeated_faces_is_not_changed() -> None:
    box = shapes.box(BRICK)
    corners, positions = with_solids_apart(box.faces, box.vertices)
    assert corners is box.faces
    assert positions is box.vertices
