import numpy as np
import pytest

from segcore import shapes
from segcore.affinity.boundary_features import (
    FEATURES,
    boundary_probability,
    edge_features,
)
from segcore.affinity.measurements import measure
from segcore.affinity.patch_fields import TENSOR_RADII, THICKNESS_RADII, patch_fields
from segcore.clean.edge_geometry import across_edges
from segcore.clean.surface import build_surface
from segcore.learned.models import learned_models
from segcore.mesh import Mesh


def measured_fields(mesh):
    surface = build_surface(mesh)
    measured = measure(surface, 0)
    return surface, measured, patch_fields(surface, measured)


def squeezed(x):
    return np.sign(x) * np.log1p(np.abs(x))


def expected_features(surface, measured, fields):
    """The features by name, in numpy, one formula each."""
    sides = measured.patches.of_face[surface.edge_faces]
    across = across_edges(surface)
    ends = surface.vertices[surface.edge_vertices]
    along = ends[:, 1] - ends[:, 0]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    tensor, mean, mean_gradient, thickness, thickness_gradient, confidence = (
        field[sides].mean(axis=1) for field in fields[:-1]
    )
    xx, yy, zz, xy, xz, yz = np.moveaxis(tensor, 2, 0)
    matrix = np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), (0, 1), (2, 3))
    columns = {
        "dihedral": squeezed(measured.edges.dihedral / measured.edges.typical_dihedral),
        "k1": squeezed(measured.size * measured.curvatures.k1[surface.edge_vertices].mean(axis=1)),
        "k2": squeezed(measured.size * measured.curvatures.k2[surface.edge_vertices].mean(axis=1)),
        "bending": np.log1p(measured.bending),
        "change": np.log1p(measured.change),
        "thickness": thickness[:, 1],
        "thickness_slope": np.log1p(np.abs((thickness_gradient[:, 1] * along).sum(axis=1))),
        "thickness_excess_near": thickness[:, 0] - thickness[:, 1],
        "thickness_excess_far": thickness[:, 1] - thickness[:, 2],
        "confidence": confidence,
    }
    for s, radius in enumerate(TENSOR_RADII):
        columns[f"across_{radius}"] = squeezed(np.einsum("ni,nij,nj->n", across, matrix[:, s], across))
        columns[f"along_{radius}"] = squeezed(np.einsum("ni,nij,nj->n", along, matrix[:, s], along))
        columns[f"twist_{radius}"] = np.log1p(np.abs(np.einsum("ni,nij,nj->n", across, matrix[:, s], along)))
    for s, radius in enumerate(TENSOR_RADII[1:]):
        columns[f"mean_step_{radius}"] = np.log1p(np.abs((mean_gradient[:, s] * across).sum(axis=1)))
        columns[f"mean_excess_{radius}"] = squeezed(mean[:, s] - mean[:, s + 1])
    for s, radius in enumerate(THICKNESS_RADII):
        columns[f"thickness_step_{radius}"] = np.log1p(np.abs((thickness_gradient[:, s] * across).sum(axis=1)))
    return columns


@pytest.mark.parametrize("mesh", [shapes.burr(4).mesh, shapes.dumbbell(rings=40, around=24).mesh])
def test_features_are_those_of_their_formulas(mesh):
    surface, measured, fields = measured_fields(mesh)
    features = edge_features(surface, measured, fields, slice(None))
    expected = expected_features(surface, measured, fields)
    assert set(expected) == set(FEATURES)
    for column, name in enumerate(FEATURES):
        np.testing.assert_allclose(features[:, column], expected[name], atol=1e-9, err_msg=name)


def test_chosen_edges_have_the_features_that_they_have_among_all():
    surface, measured, fields = measured_fields(shapes.burr(3).mesh)
    chosen = np.array([5, 0, 77, 5])
    whole = edge_features(surface, measured, fields, slice(None))
    np.testing.assert_array_equal(edge_features(surface, measured, fields, chosen), whole[chosen])
    assert np.isfinite(whole).all()


def test_the_mean_curvature_of_patches_of_a_ball_is_one_over_its_radius_at_every_scale():
    _, measured, fields = measured_fields(shapes.icosphere(5))
    size = np.sqrt(measured.patches.area.sum())
    np.testing.assert_allclose(fields.mean, size / 0.5, rtol=0.05)  # the radius is half the extent
    assert np.linalg.norm(fields.mean_gradient, axis=2).max() < 1.5  # at the ends of a neck it is over 10


def test_features_have_no_unit():
    mesh = shapes.burr(4).mesh
    small, large = (
        edge_features(*measured_fields(each), slice(None)) for each in (mesh, Mesh(mesh.vertices * 1024, mesh.faces))
    )
    np.testing.assert_array_equal(small, large)


def test_the_probability_is_that_of_the_model_for_the_features():
    surface, measured, fields = measured_fields(shapes.burr(3).mesh)
    features = edge_features(surface, measured, fields, slice(None))
    expected = learned_models().boundary.probability(features)
    np.testing.assert_array_equal(boundary_probability(surface, measured), expected)


def test_the_fields_are_views_of_their_rows():
    _, _, fields = measured_fields(shapes.icosphere(3))
    assert all(np.shares_memory(field, fields.rows) for field in fields)
    flat = np.concatenate([field.reshape(len(fields.rows), -1) for field in fields[:-1]], axis=1)
    np.testing.assert_array_equal(flat, fields.rows)
