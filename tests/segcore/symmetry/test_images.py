import numpy as np
import pytest

from helpers.bodies.creatures import creature
from helpers.meshes import moved, rotation
from segcore import shapes
from segcore.array_kernels import face_centroids
from segcore.clean.surface import build_surface
from segcore.symmetry.images import image_under, mirror_image
from segcore.symmetry.reflection import Reflection

ACROSS_X = Reflection(np.array([1.0, 0.0, 0.0]), 0.0)


def test_on_a_symmetric_mesh_the_image_of_a_face_is_its_mirror_image():
    surface = build_surface(creature())
    mirror = mirror_image(surface)
    assert mirror is not None
    assert mirror.meshed_alike
    assert (mirror.is_first[mirror.of_face] != mirror.is_first).all()
    centres = face_centroids(surface.vertices, surface.faces)
    beside = np.flatnonzero(np.abs(mirror.reflection.heights(centres)) > 1e-9)  # the plane halves the other faces
    assert len(beside) > 5000
    np.testing.assert_array_equal(mirror.of_face[mirror.of_face[beside]], beside)
    images = mirror.reflection.of_points(centres)
    np.testing.assert_allclose(centres[mirror.of_face[beside]], images[beside], atol=1e-9)
    assert mirror.is_first[np.abs(mirror.reflection.heights(centres)) <= 1e-9].all()


def test_on_any_other_mesh_of_a_symmetric_shape_the_image_is_near_the_mirror_image():
    surface = build_surface(creature(rotation(np.random.default_rng(1)), subdivisions=5))
    mirror = mirror_image(surface)
    assert mirror is not None
    assert not mirror.meshed_alike
    centres = face_centroids(surface.vertices, surface.faces)
    away = np.linalg.norm(centres[mirror.of_face] - mirror.reflection.of_points(centres), axis=1)
    assert np.quantile(away / np.sqrt(surface.areas), 0.99) < 2.0
    assert (mirror.is_first[mirror.of_face] != mirror.is_first).all()


def test_the_image_of_a_component_is_one_component():
    """Two pairs of balls that intersect: near an intersection the nearest face may belong to the other ball."""
    near, far = (moved(shapes.icosphere(3, 0.5), (x, 0.0, 0.0)) for x in (1.0, 1.6))
    left = [moved(shapes.icosphere(3, 0.5), (x, 0.0, 0.0)) for x in (-1.6, -1.0)]
    surface = build_surface(shapes.joined(near, far, *left).mesh)
    mirror = image_under(surface, ACROSS_X)
    assert mirror is not None
    ball = np.repeat(np.arange(4), len(near.faces))
    np.testing.assert_array_equal(ball[mirror.of_face], 3 - ball)


@pytest.mark.parametrize(("radius", "symmetric"), [(0.3, False), (0.01, True)])
def test_a_component_without_an_image_is_allowed_only_if_it_is_negligible(radius, symmetric):
    balls = [moved(shapes.icosphere(3), (x, 0.0, 0.0)) for x in (-2.0, 2.0)]
    alone = moved(shapes.icosphere(1, radius), (2.0, 0.0, 1.2))
    assert (image_under(build_surface(shapes.joined(*balls, alone).mesh), ACROSS_X) is not None) == symmetric


def test_a_surface_beside_the_plane_has_no_image():
    surface = build_surface(shapes.box())
    assert image_under(surface, Reflection(np.array([1.0, 0.0, 0.0]), 2.0)) is None
