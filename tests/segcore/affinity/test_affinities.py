import numpy as np

from segcore import shapes
from segcore.affinity.affinities import concavity
from segcore.affinity.measurements import measure
from segcore.clean.edge_geometry import dihedral_angles, edge_lengths
from segcore.clean.surface import build_surface
from segcore.mesh import Mesh
from segcore.parameters import SegmentationParameters


def test_the_edges_of_a_box_bend_by_a_right_angle_and_none_is_concave():
    surface = build_surface(shapes.box())
    angles = np.sort(dihedral_angles(surface))
    np.testing.assert_allclose(angles, [0] * 6 + [np.pi / 2] * 12, atol=1e-12)
    np.testing.assert_array_equal(measure(surface, 0).bending, 0.0)


def test_a_valley_is_concave_from_its_upper_side():
    """A folded sheet closed below: the fold bends inward by 90 degrees and has the least affinity."""
    profile = [(-1, 1), (0, 0), (1, 1), (1, -1), (-1, -1)]
    front, back = [(x, 0.0, z) for x, z in profile], [(x, 1.0, z) for x, z in profile]
    sides = [f for i in range(5) for j in [(i + 1) % 5] for f in ((i, i + 5, j), (j, i + 5, j + 5))]
    caps = [(1, 2, 3), (1, 3, 4), (1, 4, 0), (6, 8, 7), (6, 9, 8), (6, 5, 9)]
    surface = build_surface(Mesh(np.array(front + back), np.array(sides + caps)))
    angles = dihedral_angles(surface)
    fold = (surface.edge_vertices == [1, 6]).all(axis=1)
    np.testing.assert_allclose(angles[fold], -np.pi / 2)
    assert (angles[~fold] >= -1e-12).all()
    assert concavity(surface, SegmentationParameters()).value[fold] < 0.3
    assert (measure(surface, 0).bending > 0).tolist() == fold.tolist()
    np.testing.assert_allclose(edge_lengths(surface)[fold], 1 / surface.unit)


def test_affinity_has_no_unit():
    mesh = shapes.burr(4).mesh
    small = concavity(build_surface(mesh), SegmentationParameters()).value
    large = concavity(build_surface(Mesh(mesh.vertices * 1024, mesh.faces)), SegmentationParameters()).value
    np.testing.assert_array_equal(small, large)
    moved = concavity(
        build_surface(Mesh(mesh.vertices * 1000 + [5, -7, 3], mesh.faces)), SegmentationParameters()
    ).value
    assert np.quantile(np.abs(moved - small), 0.75) < 0.1  # rounding changes which faces make a patch
    assert small.min() < 0.2
    assert small.max() <= 1
