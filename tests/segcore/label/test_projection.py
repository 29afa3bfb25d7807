import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.graphs import is_connected
from helpers.trees import members, two_sides
from segcore import shapes
from segcore.clean.surface import build_surface
from segcore.graphs.surface_graph import components_within
from segcore.graphs.tree import Tree
from segcore.label.projection import Votes, _connected, project
from segcore.mesh import Mesh

SURFACE = build_surface(shapes.icosphere(1))
FACES = SURFACE.face_graph()


@st.composite
def trees(draw):
    """Random trees over the 42 vertices of a sphere, with leaves that are not connected."""
    splits = draw(st.integers(0, 8))
    leaves, split_node = [0], []
    for s in range(splits):
        split_node.append(leaves.pop(draw(st.integers(0, len(leaves) - 1))))
        leaves += [2 * s + 1, 2 * s + 2]
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    leaf = rng.choice(leaves, 42).astype(np.int32)
    return Tree(np.array(split_node, np.int32), np.ones(splits), leaf, draw(st.integers(1, splits + 1)))


@settings(max_examples=60)
@given(trees())
def test_every_node_of_the_tree_over_the_faces_is_a_connected_set_of_faces(tree):
    projected = project(tree, Votes.of_corners(SURFACE.faces), FACES)
    for faces in members(projected):
        assert faces.any()
        assert is_connected(FACES, faces)
    assert 1 <= projected.automatic_segments <= min(tree.automatic_segments, len(projected.split_node) + 1)


def test_a_clean_cut_of_the_vertices_is_kept():
    upper = SURFACE.vertices[:, 2] > 0.01
    tree = two_sides(upper)
    projected = project(tree, Votes.of_corners(SURFACE.faces), FACES)
    votes = upper[SURFACE.faces].sum(axis=1) >= 2
    assert len(set(projected.leaf[votes])) == len(set(projected.leaf[~votes])) == 1
    np.testing.assert_array_equal(projected.split_node, [0])
    np.testing.assert_array_equal(projected.cut_value, [1])


@settings(max_examples=60)
@given(st.integers(0, 10**6))
def test_the_largest_piece_of_each_side_stays_when_the_sides_are_made_connected(seed):
    side = np.random.default_rng(seed).random(len(SURFACE.faces)) < 0.5
    connected = _connected(FACES, side)
    assert is_connected(FACES, connected)
    assert is_connected(FACES, ~connected)
    piece, count = components_within(FACES.edges, side)
    volume = np.bincount(piece, FACES.volume, count)
    for which in (True, False):
        largest = max(set(piece[side == which]), key=lambda p: volume[p])
        assert (connected[piece == largest] == which).all()


def test_a_small_component_that_lies_apart_does_not_take_the_place_of_a_split():
    """Of very many components the small ones are merged with others, and no edge leads to them."""
    sphere = shapes.icosphere(1)
    speck = Mesh(0.01 * sphere.vertices + [1.5, 0.0, 1.5], sphere.faces)
    surface = build_surface(shapes.joined(sphere, speck).mesh)
    upper = surface.vertices[:, 2] > 0.01
    projected = project(two_sides(upper), Votes.of_corners(surface.faces), surface.face_graph())
    votes = upper[surface.faces].sum(axis=1) >= 2
    assert len(set(projected.leaf[votes])) == len(set(projected.leaf[~votes])) == 1
    np.testing.assert_array_equal(projected.split_node, [0])


def test_a_split_that_no_face_follows_is_left_out():
    tree = two_sides(np.arange(42) != 7)
    projected = project(tree, Votes.of_corners(SURFACE.faces), FACES)
    assert len(projected.split_node) == 0
    assert projected.automatic_segments == 1


def test_the_other_splits_keep_their_steps():
    """Vertex 7 is cut off first, then the rest into three layers of which the last two splits are one step."""
    z = SURFACE.vertices[:, 2]
    leaf = np.select([np.arange(42) == 7, z > 0.3, z < -0.3], [2, 4, 6], 5).astype(np.int32)
    tree = Tree(np.array([0, 1, 3], np.int32), np.ones(3), leaf, 4, np.array([0, 1, 1], np.int32), True)
    projected = project(tree, Votes.of_corners(SURFACE.faces), FACES)
    assert len(projected.split_node) == 2
    assert projected.step.tolist() == [0, 0]
    assert projected.limit_reached
