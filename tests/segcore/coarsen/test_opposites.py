"""Both faces of a thin wall belong to one part."""

import manifold3d
import numpy as np
import pytest
from numpy.typing import NDArray
from trimesh import Trimesh
from trimesh.proximity import closest_point_naive

from helpers.bodies.plates import mesh_of
from segcore import shapes
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.clean.refinement import refine
from segcore.clean.surface import build_surface
from segcore.coarsen.clusters import Clusters, cluster_nodes
from segcore.coarsen.opposites import with_opposites
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters

T = 0.12  # thickness of the walls
# Outlines of extruded profiles, and a point on each face of every wall that a person would name.
PROFILES = {
    "angle": (
        [(0, 0), (1.2, 0), (1.2, T), (T, T), (T, 1.2), (0, 1.2)],
        [((0, 0.9), (T, 0.9)), ((0.9, 0), (0.9, T))],
    ),
    "channel": (
        [(0, 0), (1.4, 0), (1.4, 1), (1.4 - T, 1), (1.4 - T, T), (T, T), (T, 1), (0, 1)],
        [((0, 0.7), (T, 0.7)), ((0.7, 0), (0.7, T)), ((1.4, 0.7), (1.4 - T, 0.7))],
    ),
    "tee": (
        [(0, 0), (1.4, 0), (1.4, T), (0.7 + T / 2, T), (0.7 + T / 2, 1), (0.7 - T / 2, 1), (0.7 - T / 2, T), (0, T)],
        [((0.25, 0), (0.25, T)), ((0.7 - T / 2, 0.7), (0.7 + T / 2, 0.7))],
    ),
    "zed": (
        [(0, 0), (0.8, 0), (0.8, 1 - T), (1.6, 1 - T), (1.6, 1), (0.8 - T, 1), (0.8 - T, T), (0, T)],
        [((0.25, 0), (0.25, T)), ((0.8, 0.5), (0.8 - T, 0.5)), ((1.4, 1 - T), (1.4, 1))],
    ),
}
ALL_PARTED = {"angle", "channel", "tee"}  # the web of a zed goes with one of its flanges


def linked(mesh: Mesh) -> tuple[Clusters, Clusters]:
    """The clusters of a mesh before and after those on opposite faces are linked."""
    surface = refine(build_surface(mesh)).surface
    nodes = mesh_graph(surface, SegmentationParameters())
    clusters = cluster_nodes(nodes, 1000, np.random.default_rng(0))
    return clusters, with_opposites(clusters, nodes.opposites)


def test_the_weight_of_a_wall_is_a_tenth_of_its_area_over_its_thickness() -> None:
    before, after = linked(shapes.box((1.0, 1.0, 0.05)))
    scale = np.sqrt(before.graph.total_volume / 2.2)  # the graph is that of a surface of unit extent
    added = after.graph.weight.sum() - before.graph.weight.sum()
    assert added / scale == pytest.approx(0.1 / 0.05, rel=0.2)
    assert after.graph.length.sum() - before.graph.length.sum() == pytest.approx(added)
    np.testing.assert_array_equal(after.graph.volume, before.graph.volume)


def test_opposite_clusters_are_linked_and_no_others() -> None:
    before, after = linked(shapes.box((1.0, 1.0, 0.05)))
    known = {tuple(edge) for edge in before.graph.edges.tolist()}
    new = np.array([edge for edge in after.graph.edges.tolist() if tuple(edge) not in known])
    assert len(new) > 200
    apart = np.abs(np.diff(before.points[new], axis=1)[:, 0])
    assert (apart[:, 2] > 0.04).mean() > 0.95
    assert (apart[:, :2].max(axis=1) < 0.1).mean() > 0.95


def test_a_thick_body_has_no_links() -> None:
    before, after = linked(shapes.box())
    np.testing.assert_array_equal(before.graph.edges, after.graph.edges)


def test_bodies_are_not_linked_through_each_other() -> None:
    places = [(0.0, 0.0, 0.0), (0.0, 0.0, 0.051), (0.3, 0.3, 0.11)]
    before, after = linked(shapes.joined(*(shapes.box((1.0, 1.0, 0.05), place) for place in places)).mesh)
    assert before.body.max() == after.body.max() == 2
    ends = before.body[after.graph.edges]
    np.testing.assert_array_equal(ends[:, 0], ends[:, 1])


def labels_at(mesh: Mesh, places: NDArray[np.float64]) -> list[int]:
    """The automatic part at each place."""
    solid = Trimesh(mesh.vertices, mesh.faces, process=False)
    return segment(mesh).labels()[closest_point_naive(solid, places)[2]].tolist()


@pytest.mark.parametrize("radius", [0.0, 0.05, 0.1, 0.2, 0.3])
@pytest.mark.parametrize("name", PROFILES)
def test_walls_of_extruded_profiles_are_parts_with_both_faces(name: str, radius: float) -> None:
    """Inner edges are rounded. Without a crease there, the inner faces used to be parts of their own."""
    outline, walls = PROFILES[name]
    profile = manifold3d.CrossSection([np.array(outline)])
    if radius > 0:
        join = manifold3d.JoinType
        profile = profile.offset(radius, join.Miter, 8, 32).offset(-radius, join.Round, 2, 32)
    mesh = mesh_of(profile.extrude(1.0))
    found = labels_at(mesh, np.array([(x, y, 0.45) for wall in walls for x, y in wall]))
    assert found[::2] == found[1::2]
    assert len(set(found)) == len(walls) or name not in ALL_PARTED
