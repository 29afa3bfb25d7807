"""Groups of congruent parts: found whatever their place and meshing, and nothing else is grouped."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import segcore
from helpers.meshes import rotation
from helpers.part_list.copies import copy_of, gear, hand, placed
from segcore import shapes
from segcore.mesh import Mesh
from segcore.part_list import repeats as module
from segcore.part_list.repeats import Repeats
from segcore.part_list.tolerance import TOLERANCE

CUBE, BRICK = shapes.box(), shapes.box((1.0, 2.0, 3.0))
TETRAHEDRON = Mesh([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
BODIES: dict[str, Callable[[], Mesh]] = {
    "brick": lambda: BRICK,
    "cube": lambda: CUBE,
    "tetrahedron": lambda: TETRAHEDRON,
    "gear": lambda: gear(12),
    "hand": hand,
}


def repeats_of(*meshes: Mesh, tolerance: float = TOLERANCE) -> Repeats:
    joined = shapes.joined(*meshes)
    return segcore.parts(joined.mesh, joined.parts, tolerance=tolerance).repeats


def groups_of(*meshes: Mesh, tolerance: float = TOLERANCE) -> list[tuple[int, ...]]:
    return [repeat.parts for repeat in repeats_of(*meshes, tolerance=tolerance).groups]


@pytest.mark.parametrize("name", BODIES)
def test_copies_are_found_whatever_their_place_and_meshing(name: str) -> None:
    rng = np.random.default_rng(3)
    body = BODIES[name]()
    (repeat,) = repeats_of(body, copy_of(body, rng), copy_of(body, rng, times=2)).groups
    assert repeat.parts == (0, 1, 2)
    assert not any(copy.is_mirrored for copy in repeat.copies)
    assert max(copy.relative_residual for copy in repeat.copies) < 1e-3


@pytest.mark.parametrize("name", BODIES)
def test_the_transform_maps_the_first_part_to_each_other_one(name: str) -> None:
    rng = np.random.default_rng(4)
    body = BODIES[name]()
    others = [copy_of(body, rng), copy_of(body, rng, mirrored=True)]
    (repeat,) = repeats_of(body, *others).groups
    for copy, mesh in zip(repeat.copies[1:], others, strict=True):
        turned = copy.transform[:3, :3]
        np.testing.assert_allclose(turned @ turned.T, np.eye(3), atol=1e-9)
        assert (np.linalg.det(turned) < 0) == copy.is_mirrored
        assert copy.transform[3].tolist() == [0.0, 0.0, 0.0, 1.0]
        images = body.vertices @ turned.T + copy.transform[:3, 3]
        away = np.linalg.norm(images[:, None] - mesh.vertices, axis=2).min(axis=1)
        assert away.max() < 1e-3 * np.ptp(body.vertices, axis=0).max()


def test_only_a_body_without_mirror_symmetry_is_mirrored() -> None:
    rng = np.random.default_rng(5)
    for name, body in BODIES.items():
        (repeat,) = repeats_of(body(), copy_of(body(), rng, mirrored=True)).groups
        assert [copy.is_mirrored for copy in repeat.copies] == [False, name == "hand"]


@given(st.integers(0, 2**32 - 1), st.floats(1e-3, 1e3), st.booleans(), st.integers(0, 1))
@settings(max_examples=12, deadline=None)
def test_a_copy_of_any_body_in_any_unit_is_found(seed: int, scale: float, mirrored: bool, times: int) -> None:
    rng = np.random.default_rng(seed)
    body = shapes.icosphere(1)
    body = Mesh(scale * body.vertices * rng.uniform(0.6, 1.4, size=(len(body.vertices), 1)), body.faces)
    (repeat,) = repeats_of(body, copy_of(body, rng, mirrored=mirrored, times=times)).groups
    assert repeat.copies[1].is_mirrored == mirrored
    assert repeat.copies[1].relative_residual < 1e-4


def test_exact_copies_in_the_order_of_the_file_get_the_exact_motion() -> None:
    rng = np.random.default_rng(6)
    turn, shift = rotation(rng), rng.normal(size=3)
    (repeat,) = repeats_of(gear(9), placed(gear(9), turn, shift)).groups
    np.testing.assert_allclose(repeat.copies[1].transform[:3, :3], turn, atol=1e-12)
    np.testing.assert_allclose(repeat.copies[1].transform[:3, 3], shift, atol=1e-12)


def test_parts_are_turned_as_little_as_possible() -> None:
    rng = np.random.default_rng(7)
    mixed = copy_of(CUBE, rng)
    other = Mesh(mixed.vertices + np.array([3.0, 0.0, 0.0]), np.roll(mixed.faces[::-1], 1, axis=1))
    (repeat,) = repeats_of(mixed, other).groups
    np.testing.assert_allclose(repeat.copies[1].transform[:3, :3], np.eye(3), atol=1e-6)


@pytest.mark.parametrize(("factor", "are_equal"), [(1.005, True), (1.01, True), (1.04, False), (1.1, False)])
def test_parts_that_deviate_by_more_than_the_tolerance_are_not_grouped(factor: float, are_equal: bool) -> None:
    """A brick that is longer by d deviates by d / 2 at either end; the diagonal is 3.74 and the tolerance 1 %."""
    rng = np.random.default_rng(8)
    longer = shapes.box((1.0, 2.0, 3.0 * factor))
    assert (groups_of(BRICK, copy_of(longer, rng)) == [(0, 1)]) == are_equal


def test_the_residual_is_the_deviation_in_units_of_the_mesh() -> None:
    (repeat,) = repeats_of(BRICK, shapes.box((1.0, 2.0, 3.02), (5.0, 0.0, 0.0))).groups
    assert repeat.copies[1].residual == pytest.approx(0.01, abs=1e-3)
    assert repeat.copies[1].relative_residual == pytest.approx(repeat.copies[1].residual / 14**0.5)
    assert 0.0 < repeat.copies[1].mean_residual < repeat.copies[1].residual


def test_a_tolerance_can_be_given() -> None:
    longer = shapes.box((1.0, 2.0, 3.12), (5.0, 0.0, 0.0))
    assert groups_of(BRICK, longer, tolerance=0.02) == [(0, 1)]
    assert groups_of(BRICK, longer, tolerance=0.005) == []
    for wrong in (0.0, -1.0, 0.2, float("nan")):
        with pytest.raises(segcore.InvalidParameters, match="tolerance"):
            groups_of(BRICK, tolerance=wrong)


def test_similar_bodies_are_told_apart() -> None:
    rng = np.random.default_rng(9)
    bodies = [gear(12), gear(13), CUBE, BRICK, shapes.icosphere(3, 0.62), hand()]
    copies = [copy_of(body, rng) for body in bodies]
    assert groups_of(*bodies, *copies) == [(part, part + len(bodies)) for part in range(len(bodies))]


def test_spheres_of_different_fineness_are_equal() -> None:
    rng = np.random.default_rng(10)
    assert groups_of(shapes.icosphere(3), copy_of(shapes.icosphere(4), rng)) == [(0, 1)]


def test_parts_without_area_are_equal_to_none() -> None:
    dot = Mesh(np.zeros((3, 3)), [[0, 1, 2]])
    assert groups_of(dot, dot, CUBE) == []


def test_more_parts_than_can_be_compared_are_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(11)
    cubes = [copy_of(CUBE, rng) for _ in range(3)]
    assert repeats_of(*cubes).is_complete
    monkeypatch.setattr(module, "_MOST_FITS", 1)
    assert groups_of(*cubes) == [(0, 1)]
    assert not repeats_of(*cubes).is_complete
    monkeypatch.setattr(module, "_MOST_COMPARED", 2)
    assert not repeats_of(*cubes).is_complete
