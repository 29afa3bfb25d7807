"""The parts of a mesh as they are given to Blender: labels, names and colours."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from .arrays import IntArray

Color: TypeAlias = tuple[float, float, float]  # linear light, 0..1

_COLORS = Path(__file__).with_name("colors.txt")


@dataclass(frozen=True, slots=True, eq=False)
class Parts:
    """Labels of triangles or polygons, and for each label a name and a colour."""

    labels: IntArray
    names: list[str]
    colors: list[Color]


def unnamed(labels: IntArray, count: int) -> Parts:
    """The parts 0..count - 1 with the names and colours that Cleave gives them."""
    return said(labels, [("", None)] * count)


def said(labels: IntArray, of_parts: Sequence[tuple[str, str | None]]) -> Parts:
    """Parts with a name, which may be empty, and a colour ``#rrggbb``, which may be missing, for each label."""
    palette = _COLORS.read_text(encoding="ascii").split()
    names = [name.strip() or f"segment {label}" for label, (name, _) in enumerate(of_parts)]
    shown = [color or palette[label % len(palette)] for label, (_, color) in enumerate(of_parts)]
    return Parts(labels, names, [linear_color(color) for color in shown])


def linear_color(text: str) -> Color:
    """Linear light of ``#rrggbb`` in sRGB (IEC 61966-2-1), as Blender stores colours."""
    red, green, blue = (_linear(int(digits, 16) / 255) for digits in re.findall("[0-9a-fA-F]{2}", text))
    return red, green, blue


def _linear(value: float) -> float:
    return value / 12.92 if value <= 0.04045 else float(((value + 0.055) / 1.055) ** 2.4)
