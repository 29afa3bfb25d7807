import numpy as np
import pytest

from helpers.bodies.creatures import creature, limb_of_face
from helpers.meshes import rotation
from helpers.trees import grown_tree
from segcore.array_kernels import face_centroids
from segcore.clean.surface import build_surface
from segcore.graphs.surface_graph import connected_components
from segcore.label.mirrored import mirrored_places
from segcore.symmetry.images import mirror_image

BODY = creature()
SURFACE = build_surface(BODY)
MIRROR = mirror_image(SURFACE)
GRAPH = SURFACE.face_graph()
CENTRES = face_centroids(SURFACE.vertices, SURFACE.faces)
BESIDE = np.abs(MIRROR.reflection.heights(CENTRES)) > 1e-9  # the plane halves the other faces
# Two splits in a row: the leaves 0 and 1 are the sides of the second one, leaf 2 that of the first.
TWO_SPLITS = np.array([-1, 1, 0], dtype=np.int32)


def arms(share):
    """Leaf 0 is the arm with x < 0, leaf 2 that with x > 0, cut off farther away by a share; leaf 1 is the rest."""
    away = np.linalg.norm(BODY.corners.mean(axis=1), axis=1)
    limb = limb_of_face(BODY)
    left, right = (limb == 5) & (away > 1.6), (limb == 2) & (away > 1.6 * (1 + share))
    return np.where(left, 0, np.where(right, 2, 1)).astype(np.int32)


def test_the_second_half_gets_the_boundaries_of_the_first():
    before = arms(0.2)
    drawn = mirrored_places(before, TWO_SPLITS, GRAPH, MIRROR)
    assert (np.bincount(before)[[0, 2]] > 10).all()
    assert np.bincount(before)[0] > np.bincount(before)[2]
    np.testing.assert_array_equal(drawn[MIRROR.is_first], before[MIRROR.is_first])
    np.testing.assert_array_equal(drawn[MIRROR.of_face[BESIDE]], 2 - drawn[BESIDE])


def test_leaves_that_are_not_images_of_each_other_stay():
    """One arm is a leaf and the other is not."""
    one_arm = np.minimum(arms(0.0), 1)
    assert mirrored_places(one_arm, np.array([-1, 0], dtype=np.int32), GRAPH, MIRROR) is one_arm


def test_a_mesh_that_is_not_symmetric_itself_keeps_its_boundaries():
    surface = build_surface(creature(rotation(np.random.default_rng(1))))
    mirror = mirror_image(surface)
    places = (face_centroids(surface.vertices, surface.faces)[:, 1] > 0).astype(np.int32)
    assert mirrored_places(places, np.array([-1, 0], dtype=np.int32), surface.face_graph(), mirror) is places


@pytest.mark.parametrize("seed", range(8))
def test_every_leaf_stays_connected_and_none_vanishes(seed):
    tree = grown_tree(GRAPH, 7, seed)
    intervals = tree.leaf_intervals()
    place = intervals.first[tree.leaf]
    split_at = np.zeros(7, dtype=np.int32)
    split_at[intervals.first[2::2]] = np.arange(6)
    drawn = mirrored_places(place, split_at, GRAPH, MIRROR)
    inside = drawn[GRAPH.edges[:, 0]] == drawn[GRAPH.edges[:, 1]]
    assert len(np.unique(drawn)) == 7
    assert connected_components(GRAPH.edges[inside], GRAPH.node_count).max() == 6
