"""Draws segmentations side by side."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from segcore.arrays import IntArray
    from segcore.mesh import Mesh

# Set by hand, for shapes that look three-dimensional.
_SIZE = 420  # pixels of one drawing
_ASIDE = 25.0  # degrees between the view direction and the thinnest direction of the shape, to the side and upwards
_HIGHEST = 45.0  # greatest elevation in degrees

Pixels = NDArray[np.uint8]


def side_by_side(mesh: Mesh, segmentations: Sequence[IntArray]) -> Pixels:
    """(H, W, 4) pixels: several segmentations of a mesh from the same view, on white.

    Parameters
    ----------
    segmentations : (F,) each, labels from 0. A segment has the colour of the matching one in the first segmentation.
    """
    from segcore.io.picture import draw

    azimuth, elevation = broad_view(mesh)
    alike = [matched(labels, segmentations[0]) for labels in segmentations]
    pictures = [draw(mesh, labels, _SIZE, azimuth, elevation) for labels in alike]
    return on_white(np.concatenate(pictures, axis=1))


def broad_view(mesh: Mesh) -> tuple[float, float]:
    """Return azimuth and elevation in degrees of a view nearly along the least principal axis of the vertices."""
    centred = mesh.vertices - mesh.vertices.mean(axis=0)
    x, y, z = np.linalg.eigh(centred.T @ centred)[1][:, 0]
    if y < 0:
        x, y, z = -x, -y, -z
    azimuth, elevation = np.degrees([np.arctan2(x, z), np.arcsin(min(y, 1.0))])
    return float(azimuth + _ASIDE), float(min(elevation + _ASIDE, _HIGHEST))


def matched(labels: IntArray, reference: IntArray) -> IntArray:
    """Rename labels one to one such that as many faces as possible have the same label as in a reference."""
    count = max(int(labels.max()), int(reference.max())) + 1
    shared = np.bincount(labels.astype(np.int64) * count + reference, minlength=count * count).reshape(count, count)
    renamed = np.empty(count, dtype=np.int32)
    rows, columns = linear_sum_assignment(shared, maximize=True)
    renamed[rows] = columns
    result: IntArray = renamed[labels]
    return result


def save_picture(path: Path, rows: Sequence[Pixels]) -> None:
    """Write rows of drawings to a PNG file, one below the other.

    Raises
    ------
    BenchmarkError
        If the file cannot be written.
    """
    from segcore.io.picture import write_png

    widest = max(row.shape[1] for row in rows)
    whole = [np.pad(row, [(0, 0), (0, widest - row.shape[1]), (0, 0)], constant_values=255) for row in rows]
    try:
        with path.open("wb") as file:
            write_png(file, np.concatenate(whole, axis=0))
    except OSError as error:
        raise BenchmarkError(f"The picture cannot be written to {path}: {error.strerror}.") from error


def on_white(pixels: Pixels) -> Pixels:
    """(H, W, 4) opaque pixels in front of white."""
    return over(pixels, np.full((1, 1, 3), 255, dtype=np.uint8))


def over(pixels: Pixels, ground: Pixels) -> Pixels:
    """(H, W, 4) opaque pixels in front of a ground (H, W, 3), or (1, 1, 3) if it has one colour."""
    opacity = pixels[..., 3:].astype(np.float64) / 255
    color = pixels[..., :3] * opacity + ground * (1 - opacity)
    return np.concatenate([np.rint(color), np.full(opacity.shape, 255.0)], axis=2).astype(np.uint8)
