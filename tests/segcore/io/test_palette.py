"""The colours of segments."""

import numpy as np
import pytest

from segcore.io.palette import linear_rgb, related_colors, segment_colors

# Simulated colour vision deficiencies: Vienot, Brettel and Mollon 1999, another model than that of the palette.
_TO_LMS = np.array([[17.8824, 43.5161, 4.11935], [3.45565, 27.1554, 3.86714], [0.0299566, 0.184309, 1.46709]])
_DEUTERANOPE = np.array([[1, 0, 0], [0.494207, 0, 1.24827], [0, 0, 1]])
_PROTANOPE = np.array([[0, 2.02344, -2.52581], [0, 1, 0], [0, 0, 1]])


def closest(colors: np.ndarray) -> float:
    distance = np.linalg.norm(colors[:, None] - colors[None], axis=2)
    return float(distance[~np.eye(len(colors), dtype=bool)].min())


def test_the_colour_of_a_label_does_not_depend_on_how_many_there_are() -> None:
    longest = segment_colors(300)
    assert longest.shape == (300, 3)
    assert (longest >= 0).all()
    assert (longest <= 1).all()
    for n in (0, 1, 7, 64, 299):
        assert np.array_equal(segment_colors(n), longest[:n])


def test_colours_of_the_first_256_labels_differ() -> None:
    assert len(np.unique(segment_colors(256), axis=0)) == 256


def test_the_first_colours_differ_for_people_who_confuse_red_and_green() -> None:
    light = linear_rgb(segment_colors(8))
    for blindness in (_DEUTERANOPE, _PROTANOPE):
        seen = light @ (np.linalg.inv(_TO_LMS) @ blindness @ _TO_LMS).T
        assert closest(np.cbrt(np.clip(seen, 0, 1))) > 0.08


def test_colours_are_farther_apart_than_random_ones() -> None:
    random = np.random.default_rng(0).random((100, 16, 3))
    assert closest(segment_colors(16)) > np.quantile([closest(colors) for colors in random], 0.9)


def test_linear_light_is_that_of_the_standard() -> None:
    assert linear_rgb(np.array([0.0, 1.0])).tolist() == [0.0, 1.0]
    np.testing.assert_allclose(linear_rgb(np.array([0.04, 0.5])), [0.04 / 12.92, 0.21404114], rtol=1e-7)


@pytest.mark.parametrize("color", ["#56b4e9", "#f0e442", "#d55e00", "#808080", "#000000"])
def test_related_colours_have_the_hue_of_the_first_one_and_differ_in_lightness(color: str) -> None:
    related = related_colors(color, 9)
    assert related[0] == color
    assert related[6:] == related[:3]
    light = linear_rgb(np.array([list(bytes.fromhex(name[1:])) for name in related[:6]]) / 255)
    for blindness in (_TO_LMS, _DEUTERANOPE @ _TO_LMS, _PROTANOPE @ _TO_LMS):
        seen = np.cbrt(np.clip(light @ (np.linalg.inv(_TO_LMS) @ blindness).T, 0, 1))
        assert closest(seen[:4]) > 0.08
    channels = np.array([list(bytes.fromhex(name[1:])) for name in related])
    first = np.argsort(channels[0], kind="stable")
    assert (np.diff(channels[:, first], axis=1) >= -8).all()  # the order of red, green and blue, which is the hue
