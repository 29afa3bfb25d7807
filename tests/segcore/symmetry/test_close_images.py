import numpy as np
import pytest
from scipy.spatial import KDTree

from segcore.symmetry.close_images import Halves, close_images, coinciding_area

RNG = np.random.default_rng(5)
COUNT = 3000


@pytest.fixture(scope="module")
def halves():
    """Faces whose images are those of the other half, moved by less than their size."""
    centre, normal = RNG.random((COUNT, 3)) + np.array([0.0, 0.0, 0.01]), RNG.normal(size=(COUNT, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    mirrored = np.array([1.0, 1.0, -1.0])
    centre = np.concatenate([centre, (centre + RNG.normal(scale=0.01, size=centre.shape)) * mirrored])
    normal = np.concatenate([normal, normal * mirrored])
    is_first = np.arange(2 * COUNT) < COUNT
    area = RNG.uniform(0.0001, 0.0009, 2 * COUNT)
    return Halves(centre, normal, area, is_first, 0.01, np.array([0.0, 0.0, 1.0, 0.0]))


def nearest(halves, faces, among):
    mirrored = np.array([1.0, 1.0, -1.0])
    places = np.hstack([halves.centre[among], halves.far * halves.normal[among]])
    images = np.hstack([halves.centre[faces] * mirrored, halves.far * halves.normal[faces] * mirrored])
    distance, place = KDTree(places).query(images)
    return distance, among[place]


def test_the_nearest_face_is_the_one_that_a_tree_finds(halves):
    faces = np.arange(2 * COUNT, dtype=np.int32)
    for here, there in ((faces[:COUNT], faces[COUNT:]), (faces[COUNT:], faces[:COUNT])):
        found = close_images(halves, here, there)
        distance, expected = nearest(halves, here, there)
        is_near = distance < 4.0 * np.sqrt(halves.area.mean())
        np.testing.assert_array_equal(found[is_near], expected[is_near])
        assert (found[~is_near] == -1).all()


def test_no_face_is_found_among_too_many(halves):
    crowded = halves._replace(centre=1e-6 * halves.centre)
    faces = np.arange(2 * COUNT, dtype=np.int32)
    assert (close_images(crowded, faces[:COUNT], faces[COUNT:]) == -1).all()


def test_the_area_of_faces_that_coincide_with_their_images(halves):
    image = np.arange(2 * COUNT, dtype=np.int32)
    image = np.concatenate([image[COUNT:], image[:COUNT]])
    moved = np.linalg.norm(halves.centre * [1.0, 1.0, -1.0] - halves.centre[image], axis=1)
    expected = halves.area[moved <= 0.1 * np.sqrt(halves.area)].sum()
    assert 0 < expected < halves.area.sum()
    np.testing.assert_allclose(coinciding_area(0, 2 * COUNT, halves, image), [expected, halves.area.sum()])
