from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.graphs import is_connected
from helpers.meshes import agreement, areas, rotation
from helpers.trees import grown_tree, members, two_sides
from segcore import shapes
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.clean.edge_geometry import edge_lengths
from segcore.clean.surface import build_surface
from segcore.coarsen.contacts import Links
from segcore.graphs.surface_graph import connected_components
from segcore.label.boundary import BAND, draw_boundaries
from segcore.mesh import Mesh
from segcore.parameters import SegmentationParameters


def plain(mesh):
    """A surface and its face dual graph in which every edge costs its length."""
    surface = build_surface(mesh)
    return surface, mesh_graph(surface, SegmentationParameters(affinity="adjacency"))


def pieces(graph, faces):
    part = graph.subgraph(np.flatnonzero(faces).astype(np.int32))
    return connected_components(part.edges, part.node_count).max() + 1


def length_of_cut(surface, leaf):
    ends = leaf[surface.edge_faces]
    return edge_lengths(surface)[ends[:, 0] != ends[:, 1]].sum()


SPHERE, SPHERE_FACES = plain(shapes.icosphere(3))


@settings(max_examples=12)
@given(st.integers(2, 25), st.integers(0, 10**6), st.sampled_from([0.03, 0.1, 0.3]))
def test_every_part_stays_connected_and_none_vanishes(leaves, seed, band):
    tree = grown_tree(SPHERE_FACES.graph, leaves, seed)
    tree = replace(tree, step=np.arange(len(tree.split_node), dtype=np.int32) // 2, limit_reached=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("segcore.label.boundary.BAND", band)
        drawn = draw_boundaries(tree, SPHERE_FACES, Links.none(), SPHERE)
    assert len(drawn.split_node) == len(tree.split_node)
    assert (drawn.step.tolist(), drawn.limit_reached) == (tree.step.tolist(), True)
    for faces in members(drawn):
        assert faces.any()
        assert is_connected(SPHERE_FACES.graph, faces)
    volume = [SPHERE.areas[faces].sum() for faces in members(drawn)]
    assert all(one >= other * (1 - 1e-9) for one, other in zip(volume[1::2], volume[2::2], strict=True))


@pytest.mark.parametrize("seed", range(3))
def test_a_jagged_boundary_becomes_short(seed):
    """A random outline across a ball, in a random direction, and the great circle that it runs along."""
    surface, nodes = plain(shapes.icosphere(5))
    rng = np.random.default_rng(seed)
    towards = nodes.points @ rotation(rng)
    height = towards[:, 2] / np.abs(towards).max()
    angle = np.arctan2(towards[:, 1], towards[:, 0])
    jagged = height > 0.07 * np.sin(19 * angle)
    drawn = draw_boundaries(two_sides(jagged), nodes, Links.none(), surface).leaf
    straight = length_of_cut(surface, (height > 0).astype(int))
    assert length_of_cut(surface, jagged.astype(int)) > 1.25 * straight
    assert length_of_cut(surface, drawn) < 1.05 * straight


def test_a_boundary_falls_into_the_groove_beside_it():
    surface, nodes = plain(shapes.icosphere(5))
    middle = surface.vertices[surface.edge_vertices].mean(axis=1)[:, 2]
    groove = np.abs(middle) < 0.008
    weight = nodes.graph.weight * np.where(groove, 0.03, 1.0)
    grooved = replace(nodes, graph=nodes.graph._replace(weight=weight))
    size = np.sqrt(surface.areas.sum())
    for offset, falls in ((0.7, True), (1.6, False)):
        tree = two_sides(nodes.points[:, 2] > offset * BAND * size)
        drawn = draw_boundaries(tree, grooved, Links.none(), surface)
        ends = drawn.leaf[nodes.graph.edges]
        on_groove = groove[ends[:, 0] != ends[:, 1]].mean()
        assert on_groove > 0.9 if falls else on_groove == 0


def test_faces_far_from_a_boundary_keep_their_side():
    surface, nodes = plain(shapes.icosphere(5))
    size = np.sqrt(surface.areas.sum())
    side = nodes.points[:, 2] > 0.02 * np.sin(9 * np.arctan2(nodes.points[:, 1], nodes.points[:, 0]))
    drawn = draw_boundaries(two_sides(side), nodes, Links.none(), surface)
    far = np.abs(nodes.points[:, 2]) > 0.021 + BAND * size
    changed = (drawn.leaf == drawn.leaf[np.argmax(nodes.points[:, 2])]) != side
    assert changed.any()
    assert not changed[far].any()


def test_a_coarse_mesh_is_left_alone():
    surface, nodes = plain(shapes.box())
    tree = two_sides(np.arange(12) < 6)
    np.testing.assert_array_equal(draw_boundaries(tree, nodes, Links.none(), surface).leaf, tree.leaf)


def test_the_costs_of_the_boundaries_do_not_rise():
    mesh = shapes.dumbbell().mesh
    surface, nodes = plain(mesh)
    tree = grown_tree(nodes.graph, 8, 3)
    drawn = draw_boundaries(tree, nodes, Links.none(), surface)
    assert length_of_cut(surface, drawn.leaf) < 0.8 * length_of_cut(surface, tree.leaf)
    assert agreement(drawn.leaf, tree.leaf, areas(mesh)) > 0.8


def test_parts_in_several_components_stay_linked():
    mesh = shapes.joined(
        shapes.icosphere(3), Mesh(shapes.icosphere(3).vertices + np.array([0, 0, 1.9]), shapes.icosphere(3).faces)
    )
    surface, nodes = plain(mesh.mesh)
    upper, lower = np.flatnonzero(mesh.parts == 1), np.flatnonzero(mesh.parts == 0)
    link = np.array([[lower[np.argmax(nodes.points[lower, 2])], upper[np.argmin(nodes.points[upper, 2])]]], np.int32)
    tree = two_sides(nodes.points[:, 0] > 0.01)
    drawn = draw_boundaries(replace(tree), nodes, Links(link, np.ones(1), np.zeros(1)), surface)
    linked = nodes.graph.with_edges(link, np.ones(1), np.ones(1))
    before, after = ([pieces(linked, leaf == k) for k in (1, 2)] for leaf in (tree.leaf, drawn.leaf))
    assert after <= before
