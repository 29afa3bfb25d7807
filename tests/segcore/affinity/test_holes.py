"""Which faces belong to the walls of holes."""

import manifold3d
import numpy as np
import pytest

from helpers.bodies.plates import CENTRE, FAR, mesh_of, plate, rod
from segcore.affinity.holes import hole_walls
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.affinity.regions import component_areas
from segcore.clean.edge_geometry import dihedral_angles
from segcore.clean.surface import build_surface
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters


def found(mesh: Mesh) -> np.ndarray:
    """(F,) which faces belong to walls of holes."""
    surface = build_surface(mesh)
    return hole_walls(surface, dihedral_angles(surface), component_areas(surface))


def inside(mesh: Mesh, at: tuple[float, float], radius: float) -> np.ndarray:
    """(F,) True for the faces of the wall and of the bottom of a hole."""
    near = np.linalg.norm(mesh.corners[:, :, :2] - at, axis=2).max(axis=1) < 1.001 * radius
    height = mesh.corners[:, :, 2]
    outside = (np.abs(height).min(axis=1) > 0.0999) & (np.ptp(height, axis=1) < 1e-6)
    return near & ~outside


@pytest.mark.parametrize("sides", [3, 4, 6, 8, 12, 64])
def test_the_wall_of_a_hole_of_any_number_of_sides(sides: int) -> None:
    mesh = mesh_of(plate() - rod(0.12, sides))
    wall = inside(mesh, CENTRE, 0.12)
    assert wall.sum() == 2 * sides
    np.testing.assert_array_equal(found(mesh), wall)


def test_each_of_several_holes() -> None:
    mesh = mesh_of(plate() - rod(0.12, 32) - rod(0.2, 24, FAR))
    walls = inside(mesh, CENTRE, 0.12) | inside(mesh, FAR, 0.2)
    assert walls.sum() == 2 * (32 + 24)
    np.testing.assert_array_equal(found(mesh), walls)


def test_the_bottom_of_a_blind_hole_belongs_to_its_wall() -> None:
    mesh = mesh_of(plate() - rod(0.05, 32, low=-0.08))
    hole = inside(mesh, CENTRE, 0.05)
    assert hole.sum() == 2 * 32 + 30
    np.testing.assert_array_equal(found(mesh), hole)


def test_a_hole_for_the_head_of_a_screw() -> None:
    """The wall of the wider part and the step below it are one hollow, the wall of the narrow part another."""
    mesh = mesh_of(plate() - rod(0.06, 32) - rod(0.12, 32, low=-0.02))
    np.testing.assert_array_equal(found(mesh), inside(mesh, CENTRE, 0.12))


def test_a_slot_with_an_open_side_is_no_hole() -> None:
    """The gap between two fins of a heat sink, and a notch in an edge."""
    gap = manifold3d.Manifold.cube((0.3, 3.0, 1.0), center=True).translate((0.0, 0.0, 0.5))
    notch = manifold3d.Manifold.cube((0.3, 0.4, 3.0), center=True).translate((0.0, 0.7, 0.0))
    for cut in (gap, notch):
        assert not found(mesh_of(plate() - cut)).any()


def test_a_shallow_pocket_is_no_hole() -> None:
    assert not found(mesh_of(plate() - rod(0.3, 32, low=0.05))).any()


def test_the_inside_of_a_tube_is_no_hole() -> None:
    tube = manifold3d.Manifold.cylinder(2.0, 0.5, 0.5, 48) - manifold3d.Manifold.cylinder(5.0, 0.45, 0.45, 48, True)
    assert not found(mesh_of(tube)).any()


def test_the_foot_of_a_pillar_is_no_hole() -> None:
    """The ledge around it and its sides are as hollow as a hole, and face all directions, but outward."""
    pillar = manifold3d.Manifold.cube((0.4, 0.4, 1.0), center=True).translate((0.1, 0.2, 0.5))
    for solid in (plate() + pillar, (plate() + pillar).refine_to_length(0.1)):
        assert not found(mesh_of(solid)).any()


def test_a_tiny_hole_does_not_count() -> None:
    """It could not be cut off anyway; the corners of eyes and ears are as hollow as it is."""
    assert not found(mesh_of(plate() - rod(0.002, 12))).any()


def test_a_pin_is_no_hole() -> None:
    assert not found(mesh_of(plate() + rod(0.12, 32))).any()


def test_a_finely_meshed_plate_has_the_same_hole() -> None:
    mesh = mesh_of((plate() - rod(0.12, 48)).refine_to_length(0.03))
    wall = inside(mesh, CENTRE, 0.12)
    assert wall.sum() > 300
    np.testing.assert_array_equal(found(mesh), wall)


def test_walls_have_no_volume() -> None:
    mesh = mesh_of(plate() - rod(0.12, 48))
    surface = build_surface(mesh)
    volume = mesh_graph(surface, SegmentationParameters()).graph.volume
    wall = inside(mesh, CENTRE, 0.12)
    assert (volume[wall] <= 1e-4 * surface.areas.mean()).all()
    np.testing.assert_allclose(volume[~wall], surface.areas[~wall], atol=1e-6)


def test_the_wall_of_a_hole_is_no_part_at_any_level() -> None:
    mesh = mesh_of(plate() - rod(0.12, 48) - rod(0.2, 24, FAR))
    hierarchy = segment(mesh)
    assert hierarchy.automatic_segments == 1
    for at, radius in ((CENTRE, 0.12), (FAR, 0.2)):
        wall = inside(mesh, at, radius)
        for count in range(2, hierarchy.max_segments + 1):
            labels = hierarchy.labels(count)
            assert set(labels[wall]) <= set(labels[~wall])


def test_a_hole_through_two_parts_does_not_keep_them_together() -> None:
    """Two discs on a thinner hub, with a hole along their axis."""
    disc = manifold3d.Manifold.cylinder(0.1, 1.0, 1.0, 64, center=True)
    hub = manifold3d.Manifold.cylinder(1.0, 0.4, 0.4, 64, center=True)
    spool = disc.translate((0, 0, 0.5)) + disc.translate((0, 0, -0.5)) + hub
    mesh = mesh_of(spool - manifold3d.Manifold.cylinder(3.0, 0.2, 0.2, 64, center=True))
    labels = segment(mesh).labels()
    radius = np.linalg.norm(mesh.corners[:, :, :2], axis=2)
    height = mesh.corners[:, :, 2]
    chosen = (
        (radius.min(axis=1) > 0.9) & (height.min(axis=1) > 0.4),
        (radius.min(axis=1) > 0.9) & (height.max(axis=1) < -0.4),
    )
    hub_side = (np.abs(radius - 0.4).max(axis=1) < 0.01) & (np.abs(height).max(axis=1) < 0.46)
    parts = [set(labels[part].tolist()) for part in (*chosen, hub_side)]
    assert [len(part) for part in parts] == [1, 1, 1]
    assert len(set.union(*parts)) == 3
