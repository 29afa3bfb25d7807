import numpy as np
import pytest

from segcore.coordinates import Coordinates, Unit, axis_named, unit_named
from segcore.errors import InvalidParameters


@pytest.mark.parametrize(
    ("name", "unit"),
    [("mm", "millimeter"), ("Millimetres", "millimeter"), ("inches", "inch"), ("in", "inch"), ("m", "meter")],
)
def test_units_have_abbreviations_and_other_spellings(name: str, unit: str) -> None:
    assert unit_named(name) == unit


def test_a_misspelt_unit_is_refused_with_the_nearest_one() -> None:
    with pytest.raises(InvalidParameters, match="as in 'centimeter'"):
        unit_named("centimiter")


def test_an_axis_that_cannot_point_up_is_refused() -> None:
    with pytest.raises(InvalidParameters, match="y or z"):
        axis_named("w")


@pytest.mark.parametrize(
    ("unit", "other", "factor"),
    [("meter", "millimeter", 1000), ("inch", "millimeter", 25.4), ("millimeter", "meter", 1e-3), ("foot", "inch", 12)],
)
def test_the_factor_between_units(unit: Unit, other: Unit, factor: float) -> None:
    assert Coordinates(unit).scale_to(other) == pytest.approx(factor, rel=1e-15)


def test_coordinates_in_an_unknown_unit_are_not_scaled() -> None:
    assert Coordinates().scale_to("millimeter") == 1


def test_what_points_up_still_points_up_and_right_stays_right() -> None:
    to_y, to_z = Coordinates(up="z").rotation_to("y"), Coordinates(up="y").rotation_to("z")
    assert (to_y @ [0, 0, 1]).tolist() == [0, 1, 0]
    assert (to_z @ [0, 1, 0]).tolist() == [0, 0, 1]
    assert (to_y @ [1, 0, 0]).tolist() == [1, 0, 0]
    np.testing.assert_array_equal(to_y @ to_z, np.eye(3))
    assert np.linalg.det(to_y) == pytest.approx(1)  # a rotation, not a reflection


def test_an_axis_that_is_not_known_is_not_turned_but_shown_as_usual() -> None:
    unknown = Coordinates(usual_up="z")
    np.testing.assert_array_equal(unknown.rotation_to("y"), np.eye(3))
    assert unknown.shown_up == "z"
    assert Coordinates(up="y", usual_up="z").shown_up == "y"
