import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from segcore import shapes
from segcore.affinity.measurements import measure
from segcore.affinity.thickness import _typical
from segcore.clean.surface import build_surface
from segcore.mesh import Mesh


def measured(mesh):
    surface = build_surface(mesh)
    return surface, measure(surface, 0)


def test_a_ball_is_as_thick_as_its_chords():
    surface, made = measured(shapes.icosphere(5))
    assert (made.thickness.confidence == 1).all()
    # Rays at angle a to the normal of a ball of radius r are 2 r cos(a) long.
    relative = np.exp(made.thickness.logarithm) * np.sqrt(surface.areas.sum()) / 0.5  # the radius is half the extent
    assert relative.min() > 1.5
    assert relative.max() < 2.0
    assert np.abs(made.log_thickness - made.log_thickness.mean()).max() < 0.1


def test_the_neck_of_a_dumbbell_is_thin_and_the_change_is_at_its_ends():
    shape = shapes.dumbbell(neck=0.2)
    surface, made = measured(shape.mesh)
    x = surface.vertices[surface.faces].mean(axis=1)
    axis = int(np.argmax(np.ptp(surface.vertices, axis=0)))
    near = np.abs(x[:, axis]) < 0.03
    thickness = made.log_thickness[made.patches.of_face]
    assert thickness[near].mean() < thickness.mean() - 0.5
    middle = np.abs(surface.vertices[surface.edge_vertices].mean(axis=1)[:, axis])
    assert made.change[(middle > 0.03) & (middle < 0.25)].mean() > 3 * made.change[middle > 0.35].mean()


def test_an_open_sheet_has_no_thickness_and_changes_nowhere():
    sheet = Mesh([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    _, made = measured(sheet)
    assert (made.thickness.confidence == 0).all()
    assert (made.change == 0).all()


@pytest.mark.parametrize("factor", [1e-3, 1e4])
def test_thickness_has_no_unit(factor):
    mesh = shapes.dumbbell().mesh
    _, small = measured(mesh)
    _, large = measured(Mesh(mesh.vertices * factor, mesh.faces))
    assert np.median(np.abs(np.sort(small.log_thickness) - np.sort(large.log_thickness))) < 0.02


def test_a_body_turned_inside_out_is_as_thick():
    mesh = shapes.icosphere(4)
    _, made = measured(Mesh(mesh.vertices, mesh.faces[:, ::-1]))
    assert (made.thickness.confidence == 1).all()


@given(st.integers(0, 2**32 - 1), st.floats(0, 1))
def test_the_typical_distance_is_the_weighted_mean_within_a_deviation_of_the_median(seed, share_of_misses):
    rng = np.random.default_rng(seed)
    distances, cosines = rng.lognormal(size=(6, 24)), rng.uniform(0.5, 1, 24)
    distances[rng.random(distances.shape) < share_of_misses] = np.inf
    value, confidence = _typical(distances, cosines)
    hits = np.isfinite(distances)
    np.testing.assert_allclose(confidence, hits.mean(axis=1))
    for found, row, hit in zip(value, distances, hits, strict=True):
        if not hit.any():
            assert found == 0
            continue
        near = hit & (np.abs(row - np.median(row[hit])) <= row[hit].std() * (1 + 1e-9) + 1e-9)
        expected = np.average(row[near], weights=cosines[near]) if near.any() else np.median(row[hit])
        assert found == pytest.approx(expected)


def test_opposite_faces_of_a_plate_are_found_from_both_sides():
    surface, made = measured(shapes.box((1.0, 1.0, 0.05)))
    found = made.thickness.opposites
    thin = found.distance * surface.unit < 0.06
    np.testing.assert_allclose(found.distance[thin] * surface.unit, 0.05, rtol=0.01)
    assert found.area[thin].sum() * surface.unit**2 == pytest.approx(2.0, rel=0.1)
    heights = surface.vertices[surface.faces[found.nodes[thin]]].mean(axis=2)[:, :, 2]
    np.testing.assert_allclose(np.abs(np.diff(heights, axis=1)) * surface.unit, 0.05, rtol=1e-3)
