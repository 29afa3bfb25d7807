import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.scale.hard_shapes import torus_of_random_places
from segcore import shapes
from segcore.affinity.rays import RayCaster


def nearest_exit(vertices, faces, origin, direction):
    """By brute force over all faces: the distance to the nearest one, infinity if the ray meets its front."""
    best, inside = np.inf, False
    for a, b, c in vertices[faces]:
        normal = np.cross(b - a, c - a)
        facing = normal @ direction
        if facing == 0:
            continue
        distance = normal @ (a - origin) / facing
        point = origin + distance * direction
        sides = [np.cross(q - p, point - p) @ normal for p, q in ((a, b), (b, c), (c, a))]
        if distance > 0 and min(sides) >= 0 and distance < best:
            best, inside = distance, facing > 0
    return best if inside else np.inf


@pytest.mark.slow
@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1), st.integers(1, 60))
def test_the_nearest_face_is_the_one_that_a_search_through_all_finds(seed, count):
    rng = np.random.default_rng(seed)
    vertices, faces = rng.normal(size=(3 * count, 3)), np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    origins, directions = rng.normal(size=(20, 3)), rng.normal(size=(20, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    expected = [nearest_exit(vertices, faces, o, d) for o, d in zip(origins, directions, strict=True)]
    np.testing.assert_allclose(
        RayCaster.of(vertices, faces).inner_distances(origins, directions), expected, rtol=1e-3, atol=1e-4
    )


def test_rays_from_inside_a_box_end_at_its_walls_and_those_from_outside_have_no_inner_distance():
    box = shapes.box()
    caster = RayCaster.of(box.vertices, box.faces)
    low, high = box.vertices.min(axis=0), box.vertices.max(axis=0)
    middle = 0.51 * low + 0.49 * high
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    walls = np.concatenate([high - middle, middle - low])
    np.testing.assert_allclose(caster.inner_distances(np.tile(middle, (6, 1)), axes), walls, rtol=1e-6)
    outside = middle - 3 * (high - low) * axes
    assert np.isinf(caster.inner_distances(outside, axes)).all()


def test_rays_among_faces_that_cross_everywhere_are_given_up():
    mesh = torus_of_random_places(20_000)
    rng = np.random.default_rng(0)
    origins, directions = rng.random((20_000, 3)), rng.normal(size=(20_000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    caster = RayCaster.of(mesh.vertices, mesh.faces)
    found = np.isfinite(caster.inner_distances(origins, directions))
    assert found[:50].mean() > 0.3  # half of the rays meet a face from behind
    assert found[-10_000:].mean() < 0.01


def test_no_ray_is_given_up_in_a_body():
    mesh = shapes.burr(5).mesh
    inside = -1e-3 * np.ones((50_000, 3)) + 1e-4 * np.random.default_rng(0).normal(size=(50_000, 3))
    directions = np.random.default_rng(1).normal(size=(50_000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    assert np.isfinite(RayCaster.of(mesh.vertices, mesh.faces).inner_distances(inside, directions)).all()
