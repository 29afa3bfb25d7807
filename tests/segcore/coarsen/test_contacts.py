import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.meshes import areas, moved, refined, rotation
from segcore import shapes
from segcore.clean.surface import build_surface
from segcore.coarsen.contacts import REACH, _partners, find_contacts, spread_points
from segcore.mesh import Mesh


def contacts_between(*meshes):
    """The contacts between meshes, and the unit of their surface."""
    shape = shapes.joined(*meshes)
    surface = build_surface(shape.mesh)
    points = spread_points(surface, shape.parts, 32768)
    links = find_contacts(points, shape.parts[points.face], float(np.sqrt(surface.areas.sum())))
    assert (shape.parts[links.faces[:, 0]] != shape.parts[links.faces[:, 1]]).all()
    return links, surface.unit


def length_of_contact(*meshes):
    """The length of all contacts in the unit of the meshes."""
    links, unit = contacts_between(*meshes)
    return links.length.sum() * unit


def concavity_of_contact(*meshes):
    """The mean concavity of all contacts."""
    links, _ = contacts_between(*meshes)
    return links.length @ links.concavity / links.length.sum()


SEAT = shapes.box((2, 2, 0.2))


def leg(gap=0.0, width=0.4):
    return shapes.box((width, width, 2), (0, 0, -1.1 - gap))


def test_points_are_spread_in_proportion_to_area():
    shape = shapes.joined(shapes.box(), shapes.box((2, 2, 2), (5, 0, 0)), shapes.box((0.001, 0.001, 0.001), (9, 0, 0)))
    surface = build_surface(shape.mesh)
    points = spread_points(surface, shape.parts, 3000)
    count = np.bincount(shape.parts[points.face])
    np.testing.assert_allclose(count[:2], [600, 2400], atol=1)
    assert count[2] == 1
    total = np.bincount(points.face, points.area, len(surface.faces))
    np.testing.assert_allclose(total, surface.areas, atol=2 * surface.areas.sum() / 3000)


def test_points_lie_in_their_faces():
    surface = build_surface(shapes.icosphere(2))
    points = spread_points(surface, np.zeros(len(surface.faces), np.int32), 1000)
    corners = surface.vertices[surface.faces[points.face]]
    whole = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    for k in range(3):
        part = np.cross(corners[:, (k + 1) % 3] - points.position, corners[:, (k + 2) % 3] - points.position)
        assert (np.einsum("ij,ij->i", part, whole) > -1e-12).all()


@pytest.mark.parametrize("width", [0.3, 0.4, 0.8])
def test_the_contact_of_a_leg_under_a_seat_is_as_long_as_the_perimeter_of_the_leg(width):
    layer = width**2 / (0.1 * np.sqrt(areas(shapes.joined(SEAT, leg(width=width)).mesh).sum()))
    assert length_of_contact(SEAT, leg(width=width)) == pytest.approx(4 * width + layer, rel=0.25)


def test_the_contact_of_two_shells_that_cross_grows_with_the_curve_in_which_they_cross():
    ball = shapes.icosphere(4)
    shifted = moved(ball, (0, 0, 1))
    assert length_of_contact(ball, shifted) == pytest.approx(2 * 2 * np.pi * np.sqrt(0.75), rel=0.3)


@pytest.mark.parametrize("times", [1, 3, 5])
def test_a_contact_does_not_depend_on_the_meshing(times):
    expected = length_of_contact(SEAT, leg())
    assert length_of_contact(refined(SEAT, times), leg()) == pytest.approx(expected, rel=0.12)


def test_a_contact_turns_with_the_bodies():
    turn = rotation(np.random.default_rng(0))
    turned = [Mesh(mesh.vertices @ turn, mesh.faces) for mesh in (SEAT, leg())]
    assert length_of_contact(*turned) == pytest.approx(length_of_contact(SEAT, leg()), rel=0.12)


def test_a_contact_fades_as_a_gap_opens():
    size = np.sqrt(areas(shapes.joined(SEAT, leg()).mesh).sum())
    lengths = [length_of_contact(SEAT, leg(gap * REACH * size)) for gap in (0.0, 0.5, 0.8, 1.1, 3.0)]
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[2] < 0.6 * lengths[0]
    assert lengths[3] == 0


def test_a_contact_is_concave_where_bodies_stand_on_each_other():
    assert concavity_of_contact(SEAT, leg()) > 0.2
    assert concavity_of_contact(shapes.box(), shapes.box((1, 1, 1), (1.005, 0, 0))) > 0.2


def test_a_contact_is_convex_where_one_body_is_sunk_into_the_other():
    assert concavity_of_contact(shapes.box(), shapes.box((1, 1, 1), (0.98, 0, 0))) < -0.1


def test_the_contact_of_a_coat_is_neither():
    """The coat is in front of what it covers, which is behind the coat."""
    assert abs(concavity_of_contact(SEAT, shapes.box((2.02, 2.02, 0.22)))) < 0.05


def test_layers_that_lie_on_each_other_have_a_contact_in_proportion_to_their_area():
    """Two balls, one inside the other, touch along no line."""
    size = np.sqrt(8 * np.pi)
    shell = length_of_contact(shapes.icosphere(4), shapes.icosphere(4, radius=1 - 0.5 * REACH * size))
    assert shell == pytest.approx(4 * np.pi / (0.1 * size), rel=0.1)


@given(st.integers(0, 2**32 - 1), st.integers(1, 6), st.floats(0.05, 2))
def test_partners_are_those_that_a_search_through_all_points_finds(seed, components, radius):
    rng = np.random.default_rng(seed)
    position, component = rng.random((60, 3)), rng.integers(0, components, 60)
    distance = np.linalg.norm(position[:, None] - position[None], axis=2)
    expected = {}
    for i in range(60):
        for other in set(component.tolist()) - {int(component[i])}:
            j = min(np.flatnonzero(component == other).tolist(), key=lambda j: distance[i, j])
            if distance[i, j] <= radius:
                expected[i, j] = distance[i, j]
    pairs, found = _partners(position, component, radius)
    assert len(pairs) == len(expected)
    assert dict(zip(map(tuple, pairs.tolist()), found.tolist(), strict=True)) == pytest.approx(expected)


def test_a_point_has_at_most_eight_partners():
    around = np.concatenate([np.zeros((1, 3)), np.random.default_rng(0).normal(size=(20, 3))])
    pairs, _ = _partners(around, np.arange(21), 100.0)
    np.testing.assert_array_equal(np.bincount(pairs[:, 0]), 8)
