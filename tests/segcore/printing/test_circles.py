"""The largest circle in a region."""

import manifold3d
import numpy as np
import pytest

from segcore.printing.circles import largest_circle


def region(*outlines: list[tuple[float, float]]) -> manifold3d.CrossSection:
    return manifold3d.CrossSection([np.array(outline) for outline in outlines], manifold3d.FillRule.EvenOdd)


def rectangle(width: float, height: float, x: float = 0.0, y: float = 0.0) -> list[tuple[float, float]]:
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def test_of_a_long_rectangle_it_is_in_the_middle() -> None:
    circle = largest_circle(region(rectangle(40.0, 4.0)))
    assert circle is not None
    assert circle.radius == pytest.approx(2.0, rel=0.03)
    assert circle.centre == pytest.approx([20.0, 2.0], abs=0.1)


def test_it_avoids_holes() -> None:
    frame = region(rectangle(20.0, 20.0), rectangle(14.0, 14.0, 2.0, 2.0))  # a frame with sides of 2 and 4
    circle = largest_circle(frame)
    assert circle is not None
    assert circle.radius == pytest.approx(0.98 * 4 * np.sqrt(2) / (1 + np.sqrt(2)), rel=0.01)  # in a corner
    around = circle.centre + circle.radius * 0.99 * np.array([[np.cos(a), np.sin(a)] for a in np.arange(0.0, 6.3, 0.1)])
    inside = ((around >= 0) & (around <= 20)).all(axis=1) & ~((around > 2) & (around < 16)).all(axis=1)
    assert inside.all()


def test_an_empty_region_has_none() -> None:
    assert largest_circle(region()) is None
