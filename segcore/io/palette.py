"""Colours of segments: a fixed one for each label, far apart also with a colour vision deficiency."""

from collections.abc import Mapping
from functools import cache
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import FloatArray

SegmentColors: TypeAlias = Mapping[int, str]  # #rrggbb by label; labels that do not exist are ignored

# Okabe and Ito, Color Universal Design, 2008: seven colours chosen together with people with such a deficiency.
_FIRST = ("56b4e9", "e69f00", "009e73", "cc79a7", "f0e442", "0072b2", "d55e00")
# The next three are set by hand.
_DISTINCT = 256  # colours before the sequence repeats
_STEPS = 17  # candidates per channel, every 16th value of a byte
_SHADES = 6  # related colours before they repeat; more could hardly be told apart. Set by hand
_LIGHTNESS = (0.45, 0.93)  # of the candidates in OKLab: visible on black and on white

# Linear RGB as seen with full colour vision, protanopia, deuteranopia and tritanopia.
# Machado, Oliveira and Fernandes, A physiologically-based model for simulation of color vision deficiency, 2009,
# severity 1.
_VISIONS = np.array(
    [
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    ]
)
# Ottosson, A perceptual color space for image processing, 2020.
_RGB_TO_LMS = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
_LMS_TO_OKLAB = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)


def segment_colors(n: int, chosen: SegmentColors | None = None) -> FloatArray:
    """(n, 3) sRGB colours in 0..1 of the labels 0..n - 1: those that are chosen, else a fixed one for each label.

    The fixed colour of a label does not depend on ``n``. The first 256 colours differ, then they repeat. After the
    first seven each is the candidate that is farthest from all colours before it: by the smallest distance in OKLab
    over the kinds of colour vision.
    """
    colors = _sequence(min(_DISTINCT, 1 << n.bit_length()))[np.arange(n) % _DISTINCT]
    for label, color in (chosen or {}).items():
        if 0 <= label < n:
            colors[label] = np.array(list(bytes.fromhex(color.removeprefix("#")))) / 255
    return colors


def color_bytes(n: int, chosen: SegmentColors | None = None) -> NDArray[np.uint8]:
    """(n, 3) the same colours in 0..255."""
    return np.round(255 * segment_colors(n, chosen)).astype(np.uint8)


def segment_color_names(n: int) -> list[str]:
    """Return the fixed colours of the labels 0..n - 1 as ``#rrggbb``."""
    return [f"#{bytes(color).hex()}" for color in color_bytes(n)]


def related_colors(color: str, n: int) -> list[str]:
    """Return ``n`` colours of one hue: the given one, ``#rrggbb``, then lighter and darker ones.

    The first six are as far apart in lightness as is possible, so that they differ with any kind of colour vision; then
    they repeat.
    """
    lab = _to_oklab(linear_rgb(np.array([list(bytes.fromhex(color.removeprefix("#")))]) / 255))[0]
    steps = np.linspace(*_LIGHTNESS, 2 * _DISTINCT)
    chosen = [float(lab[0])]
    while len(chosen) < min(n, _SHADES):
        gap = np.abs(steps[:, None] - np.array(chosen)).min(axis=1)
        chosen.append(float(steps[np.argmax(gap)]))
    shades = [color.lower(), *(_shade(lab, lightness) for lightness in chosen[1:])]
    return [shades[i % _SHADES] for i in range(n)]


def _shade(lab: FloatArray, lightness: float) -> str:
    """The most colourful colour with a lightness and the hue of another one, and at most as colourful as that."""
    chroma = np.linspace(1.0, 0.0, _DISTINCT)
    tried = np.column_stack([np.full(_DISTINCT, lightness), *(chroma[:, None] * lab[1:]).T])
    light = (tried @ np.linalg.inv(_LMS_TO_OKLAB).T) ** 3 @ np.linalg.inv(_RGB_TO_LMS).T
    is_possible = ((light >= 0.0) & (light <= 1.0)).all(axis=1)
    return f"#{bytes(np.round(255 * srgb(light[np.argmax(is_possible)])).astype(np.uint8)).hex()}"


def linear_rgb(srgb: FloatArray) -> FloatArray:
    """Linear light from sRGB, both in 0..1 (IEC 61966-2-1), as glTF stores its colour factors."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def srgb(linear: FloatArray) -> FloatArray:
    """sRGB from linear light, both in 0..1: the inverse of :func:`linear_rgb`."""
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055)


def oklab(srgb: FloatArray) -> FloatArray:
    """(N, 3) OKLab coordinates of sRGB colours (N, 3) in 0..1: distances between them are about as people see them."""
    seen: FloatArray = _appearance(srgb)[0]
    return seen


@cache
def _sequence(count: int) -> FloatArray:
    """(count, 3) the first fixed colours; few take little of the time of all."""
    candidates = np.concatenate([_first_colors(), _candidates()])
    seen = _appearance(candidates)
    distance = np.full(len(candidates), np.inf)
    chosen: list[int] = []
    for i in range(count):
        chosen.append(i if i < len(_FIRST) else int(np.argmax(distance)))
        gap = np.linalg.norm(seen - seen[:, chosen[-1:]], axis=2).min(axis=0)
        distance = np.minimum(distance, gap)
    return candidates[chosen]


def _first_colors() -> FloatArray:
    return np.array([list(bytes.fromhex(color)) for color in _FIRST]) / 255


def _candidates() -> FloatArray:
    ramp = np.round(np.linspace(0, 255, _STEPS)) / 255
    grid = np.stack(np.meshgrid(ramp, ramp, ramp, indexing="ij"), axis=-1).reshape(-1, 3)
    lightness = _appearance(grid)[0, :, 0]
    return grid[(lightness >= _LIGHTNESS[0]) & (lightness <= _LIGHTNESS[1])]


def _appearance(srgb: FloatArray) -> FloatArray:
    """(4, N, 3) OKLab coordinates of the colours for each kind of colour vision."""
    light = np.clip(np.einsum("vij,nj->vni", _VISIONS, linear_rgb(srgb)), 0, 1)
    return _to_oklab(light)


def _to_oklab(light: FloatArray) -> FloatArray:
    """(..., 3) OKLab coordinates of linear light (..., 3)."""
    lms = np.cbrt(np.einsum("...i,ji->...j", light, _RGB_TO_LMS))
    oklab: FloatArray = np.einsum("...i,ji->...j", lms, _LMS_TO_OKLAB)
    return oklab
