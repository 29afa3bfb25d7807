"""Contact sheets: for every set a PNG with the automatic segments of every model beside the parts of its author."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.assets.dataset import NO_PART
from bench.errors import BenchmarkError
from bench.paper.pictures import Pixels, broad_view, matched, on_white, over

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bench.assets.dataset import Asset
    from bench.assets.evaluation import AssetResult, Evaluation
    from segcore.arrays import IntArray, LongArray
    from segcore.mesh import Mesh

# Set by hand, for sheets that fit a screen in width.
_SIZE = 150  # pixels of one drawing
_COLUMNS = 5  # models in a row
_TEXT = 30  # pixels for the two lines of text under a model
_DPI = 100
_FONT = 7  # points

_Z_UP = frozenset({"robots"})  # the sets with x ahead and z up: ROS, REP 103; y is up in all others
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # weights of red, green and blue: ITU-R BT.709


def draw_tile(mesh: Mesh, automatic: IntArray, part: LongArray) -> Pixels:
    """(H, 2 H, 4) pixels: the automatic segments of a mesh and the parts of its author from the same view, on white.

    A segment has the colour of the part that it is matched to. Faces without a part are grey.

    Parameters
    ----------
    mesh : y is up; a front, if it has one, is at +z.
    automatic : (F,) segment of every face.
    part : (F,) part of every face, NO_PART if it belongs to none.
    """
    from segcore.io.picture import draw

    azimuth, elevation = _view(mesh)
    complete = np.where(part == NO_PART, part.max() + 1, part).astype(np.int32)
    segments = draw(mesh, matched(automatic, complete), _SIZE, azimuth, elevation)
    parts = draw(mesh, part.astype(np.int32), _SIZE, azimuth, elevation)
    whole = on_white(draw(mesh, np.zeros_like(automatic), _SIZE, azimuth, elevation))
    grey = np.rint(whole[..., :3] @ _LUMINANCE).astype(np.uint8)
    return np.concatenate([on_white(segments), over(parts, np.repeat(grey[..., None], 3, axis=2))], axis=1)


def upright(asset: Asset, mesh: Mesh) -> Mesh:
    """Return the mesh with y up."""
    from segcore.mesh import Mesh

    return Mesh(mesh.vertices[:, [1, 2, 0]], mesh.faces) if asset.collection in _Z_UP else mesh


def _view(mesh: Mesh) -> tuple[float, float]:
    """Return azimuth and elevation in degrees of a broad view that is not from behind."""
    azimuth, elevation = broad_view(mesh)
    return (azimuth if np.cos(np.radians(azimuth)) >= 0 else azimuth + 180), elevation


def save_sheets(folder: Path, evaluations: Sequence[Evaluation]) -> list[Path]:
    """Write SET.png for every set of the models to a folder, which is made if it does not exist; return the paths.

    Raises
    ------
    BenchmarkError
        If a file cannot be written.
    """
    paths = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name in dict.fromkeys(one.result.collection for one in evaluations):
            paths.append(folder / f"{name}.png")
            figure = sheet([one for one in evaluations if one.result.collection == name])
            figure.savefig(paths[-1], dpi=_DPI, metadata={"Software": None})
    except OSError as error:
        raise BenchmarkError(f"The sheets cannot be written to {folder}: {error.strerror}.") from error
    return paths


def sheet(evaluations: Sequence[Evaluation]) -> Figure:
    """Return the models in rows, with the name and the scores under each."""
    # Not pyplot, which has global state and may open a display.
    from matplotlib.figure import Figure

    columns = min(_COLUMNS, len(evaluations))
    rows = -(-len(evaluations) // columns)
    width, height = columns * 2 * _SIZE, rows * (_SIZE + _TEXT)
    figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI)
    for place, evaluation in enumerate(evaluations):
        row, column = divmod(place, columns)
        left, bottom = column * 2 * _SIZE, height - (row + 1) * (_SIZE + _TEXT)
        assert evaluation.pixels is not None
        figure.figimage(evaluation.pixels, left, bottom + _TEXT)
        middle = ((left + _SIZE) / width, (bottom + _TEXT) / height)
        figure.text(*middle, _caption(evaluation.result), ha="center", va="top", fontsize=_FONT)
    return figure


def _caption(result: AssetResult) -> str:
    automatic = result.automatic
    return f"{result.name}\n{automatic.segments} of {result.parts} parts, 1-Rand {abs(automatic.one_minus_rand):.3f}"
