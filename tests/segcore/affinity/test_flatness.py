import numpy as np

from helpers.bodies.plates import mesh_of, plate, rod
from segcore import shapes
from segcore.affinity.flatness import cohesive_weights, flat_regions, smooth_edges
from segcore.affinity.holes import hole_walls
from segcore.affinity.regions import component_areas
from segcore.clean.edge_geometry import dihedral_angles, edge_lengths
from segcore.clean.refinement import refine
from segcore.clean.surface import build_surface
from segcore.mesh import Mesh
from segcore.shapes import revolve


def factors(surface, affinity, is_piece=None):
    """The affinity of every edge divided by what it was, a constant."""
    length = edge_lengths(surface)
    return cohesive_weights(smooth_edges(surface, is_piece), affinity * length, length) / (affinity * length)


def turned(radius, height, around):
    return build_surface(revolve(np.array(radius, float), np.array(height, float), around))


def test_the_sides_of_a_box_are_its_flat_regions():
    surface = build_surface(shapes.box())
    region = flat_regions(surface)
    assert region.max() == 5
    np.testing.assert_array_equal(np.unique(region, return_counts=True)[1], 2)


def test_the_affinity_rises_inside_flat_faces_and_nowhere_else():
    surface = refine(build_surface(shapes.box((3, 2, 1)))).surface
    flat = np.abs(dihedral_angles(surface)) < 1e-6
    raised = factors(surface, 0.25)
    np.testing.assert_allclose(raised[flat], 2 * np.sqrt(0.25) / 0.25)
    np.testing.assert_array_equal(raised[~flat], 1)


def test_a_finely_meshed_round_surface_has_no_flat_face():
    """Its dihedral angles are below a degree, and some of its edges join faces that are flat within a degree."""
    surface = turned(np.sin(np.linspace(0, np.pi, 302)[1:-1]), -np.cos(np.linspace(0, np.pi, 302)[1:-1]), 600)
    assert np.median(np.abs(dihedral_angles(surface))) < np.deg2rad(1)
    np.testing.assert_array_equal(factors(surface, 0.25), 1)


def test_small_flat_pieces_do_not_count():
    surface = build_surface(shapes.burr(4).mesh)
    np.testing.assert_array_equal(factors(surface, 0.5), 1)


def test_the_strips_of_a_cylinder_hold_together_in_and_out():
    """Twice as strongly outside as inside a hole, and the rims not at all."""
    for outward in (True, False):
        mesh = revolve(np.array([1.0, 1.0]), np.array([0.0, 4.0]), 40)
        side = np.abs(mesh.corners[:, :, 2].max(axis=1) - mesh.corners[:, :, 2].min(axis=1)) > 1
        refined = refine(build_surface(Mesh(mesh.vertices, mesh.faces[side])))
        surface = refined.surface
        along = np.abs(np.abs(dihedral_angles(surface)) - np.deg2rad(9)) < 1e-6
        assert along.sum() > 40
        if not outward:
            surface = _inside_out(surface)
        raised = factors(surface, 0.25, refined.is_piece)
        np.testing.assert_allclose(raised[along], 4.0 if outward else 2.0)
        np.testing.assert_allclose(raised[~along], 4.0)


def test_the_wall_of_a_hole_holds_together_and_its_rims_do_not():
    surface = build_surface(mesh_of(plate() - rod(0.12, 48)))
    wall = hole_walls(surface, dihedral_angles(surface), component_areas(surface))
    assert wall.sum() == 2 * 48
    a, b = wall[surface.edge_faces].T
    raised = factors(surface, 0.25)
    np.testing.assert_allclose(raised[a & b], 4.0)
    np.testing.assert_array_equal(raised[a != b], 1.0)


def _inside_out(surface):
    from dataclasses import replace

    return replace(surface, faces=surface.faces[:, ::-1].copy(), normals=-surface.normals)
