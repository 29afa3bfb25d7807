"""Names and colours are those that Cleave gives to segments in its files."""

import numpy as np

from integrations.blender.parts import said, unnamed
from segcore.io.names import segment_names
from segcore.io.palette import linear_rgb, segment_colors

_LABELS = np.zeros(1, dtype=np.int32)


def test_names_and_colors_are_those_of_files() -> None:
    count = 300  # more than there are colours
    parts = unnamed(_LABELS, count)
    assert parts.names == segment_names(None, count)
    assert np.allclose(parts.colors, linear_rgb(segment_colors(count)), atol=1e-6)


def test_what_is_said_of_a_part_takes_precedence() -> None:
    parts = said(_LABELS, [("left arm", "#ff0000"), ("", "#0000ff"), (" seat ", None)])
    assert parts.names == ["left arm", "segment 1", "seat"]
    assert parts.colors[:2] == [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    assert np.allclose(parts.colors[2], linear_rgb(segment_colors(3))[2], atol=1e-6)
