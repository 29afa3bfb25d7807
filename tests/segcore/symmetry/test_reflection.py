import numpy as np
import pytest

from helpers.bodies.creatures import creature
from helpers.meshes import moved, refined, rotation
from segcore import shapes
from segcore.array_kernels import area_moments
from segcore.clean.surface import build_surface
from segcore.mesh import Mesh
from segcore.symmetry.reflection import Reflection, find_reflection


def turns(count):
    return [rotation(np.random.default_rng(seed)) for seed in range(count)]


@pytest.mark.parametrize("turn", turns(3))
def test_the_plane_of_a_symmetric_body_is_found_in_any_position(turn):
    mesh = creature()
    found = find_reflection(build_surface(moved(Mesh(mesh.vertices @ turn.T, mesh.faces), (3.0, -1.0, 5.0))))
    assert found is not None
    assert abs(found.normal @ turn[:, 0]) > 1 - 1e-6


@pytest.mark.parametrize("turn", turns(3))
def test_the_plane_does_not_depend_on_the_meshing(turn):
    surface = build_surface(creature(turn, subdivisions=5))
    found = find_reflection(surface)
    assert found is not None
    assert abs(found.normal[0]) > 1 - 1e-4
    # The input has the plane x = 0; the surface is centred and scaled to the extent 1.
    centre = 0.5 * (creature(turn, 5).vertices.min(axis=0) + creature(turn, 5).vertices.max(axis=0))
    expected = -found.normal[0] * centre[0] / surface.unit
    assert found.offset == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("mesh", [creature(missing=1), creature(missing=2), creature(turns(1)[0], 5, missing=1)])
def test_a_body_that_lacks_a_limb_has_no_plane(mesh):
    assert find_reflection(build_surface(mesh)) is None


def test_of_several_planes_the_one_that_pairs_the_most_distant_parts_is_chosen():
    found = find_reflection(build_surface(shapes.dumbbell().mesh))
    assert found is not None
    np.testing.assert_allclose(np.abs(found.normal), [0, 0, 1], atol=1e-9)


def test_points_without_area_have_no_plane():
    assert find_reflection(build_surface(Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]], dtype=np.int32)))) is None


def test_a_reflection_is_recovered_from_points_and_their_images():
    rng = np.random.default_rng(0)
    normal = rotation(rng)[:, 0]
    true = Reflection(normal, 0.3)
    points = rng.normal(size=(50, 3)) * [1.0, 2.0, 3.0]
    found = Reflection.between(points, true.of_points(points))
    np.testing.assert_allclose(found.of_points(points), true.of_points(points), atol=1e-9)
    np.testing.assert_allclose(true.of_points(true.of_points(points)), points, atol=1e-12)
    np.testing.assert_allclose(true.heights(true.of_points(points)), -true.heights(points), atol=1e-12)


def moments(mesh):
    surface = build_surface(mesh)
    return area_moments(surface.vertices, surface.faces, surface.areas)


def test_the_moments_are_integrals_over_the_area():
    """Those of a sphere of radius r: centre 0, covariance r^2 / 3; and the same for any division of the faces."""
    coarse = creature(subdivisions=3)
    once, again = (moments(mesh) for mesh in (coarse, refined(coarse, 1)))
    np.testing.assert_allclose(once[0], again[0], atol=1e-12)
    np.testing.assert_allclose(once[1], again[1], atol=1e-12)
    centre, covariance = moments(shapes.icosphere(5))  # scaled to radius 1 / 2
    np.testing.assert_allclose(centre, 0.0, atol=1e-12)
    np.testing.assert_allclose(covariance, np.eye(3) / 12, atol=1e-3)
