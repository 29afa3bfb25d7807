"""Segmentations drawn side by side."""

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

_SIZE = 420  # pixels of one drawing
_ASIDE = 25.0  # degrees by which the viewer stands beside and above the direction in which a shape is thinnest
_HIGHEST = 45.0  # degrees above or below which no viewer stands

Pixels = NDArray[np.uint8]


def side_by_side(mesh: Mesh, segmentations: Sequence[IntArray]) -> Pixels:
    """(H, W, 4): one mesh in several segmentations, all seen from the same side, on white.

    Parameters
    ----------
    segmentations : (F,) each, labels from 0. A segment has the colour of the one of the first segmentation that it is
        matched with.
    """
    from segcore.io.picture import draw

    azimuth, elevation = broad_view(mesh)
    alike = [matched(labels, segmentations[0]) for labels in segmentations]
    pictures = [draw(mesh, labels, _SIZE, azimuth, elevation) for labels in alike]
    return _on_white(np.concatenate(pictures, axis=1))


def broad_view(mesh: Mesh) -> tuple[float, float]:
    """Azimuth and elevation in degrees: nearly along the least principal axis of the vertices, so that much is seen."""
    centred = mesh.vertices - mesh.vertices.mean(axis=0)
    x, y, z = np.linalg.eigh(centred.T @ centred)[1][:, 0]
    if y < 0:
        x, y, z = -x, -y, -z
    azimuth, elevation = np.degrees([np.arctan2(x, z), np.arcsin(min(y, 1.0))])
    return float(azimuth + _ASIDE), float(min(elevation + _ASIDE, _HIGHEST))


def matched(labels: IntArray, reference: IntArray) -> IntArray:
    """The same segments with the labels of a reference: one to one, with as many faces alike as possible."""
    count = max(int(labels.max()), int(reference.max())) + 1
    shared = np.bincount(labels.astype(np.int64) * count + reference, minlength=count * count).reshape(count, count)
    renamed = np.empty(count, dtype=np.int32)
    rows, columns = linear_sum_assignment(shared, maximize=True)
    renamed[rows] = columns
    result: IntArray = renamed[labels]
    return result


def save_picture(path: Path, rows: Sequence[Pixels]) -> None:
    """Write rows of drawings, side by side or below each other, into a PNG file.

    Raises
    ------
    BenchmarkError
        Where the file cannot be written.
    """
    from segcore.io.picture import write_png

    widest = max(row.shape[1] for row in rows)
    whole = [np.pad(row, [(0, 0), (0, widest - row.shape[1]), (0, 0)], constant_values=255) for row in rows]
    try:
        with path.open("wb") as file:
            write_png(file, np.concatenate(whole, axis=0))
    except OSError as error:
        raise BenchmarkError(f"The picture cannot be written to {path}: {error.strerror}.") from error


def _on_white(pixels: Pixels) -> Pixels:
    opacity = pixels[..., 3:].astype(np.float64) / 255
    color = pixels[..., :3] * opacity + 255 * (1 - opacity)
    return np.concatenate([np.rint(color), np.full(opacity.shape, 255.0)], axis=2).astype(np.uint8)
