"""Convex hulls and convex pieces, by which simulators find collisions."""

import json
import subprocess
import sys
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from segcore.arrays import FloatArray
from segcore.errors import MissingPackage
from segcore.robots import decomposition
from segcore.robots.decomposition import OPTIONS, PART, PIECES
from segcore.robots.masses import Solid
from segcore.robots.options import RobotOptions

# Of the search of CoACD, set by hand: its defaults take about ten times as long or more, at their concavity of 0.05.
_SEARCH = {"mcts_iterations": 10, "mcts_nodes": 6, "mcts_max_depth": 1, "resolution": 500}
_ONE_AT_A_TIME = Lock()  # CoACD uses all cores


def convex_hull(points: FloatArray) -> Solid | None:
    """Return the convex hull of points (N, 3); None if they are nearly in a plane."""
    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):
        return None
    place = np.zeros(len(points), dtype=np.int32)
    place[hull.vertices] = np.arange(len(hull.vertices))
    corners = points[hull.simplices]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    is_inward = np.einsum("fj,fj->f", across, hull.equations[:, :3]) < 0
    faces = np.where(is_inward[:, None], hull.simplices[:, ::-1], hull.simplices)
    return Solid(points[hull.vertices], place[faces])


def convex_pieces(parts: Mapping[int, Solid], options: RobotOptions) -> dict[int, list[Solid]]:
    """Return convex pieces that cover each part; parts at which CoACD fails are left out.

    CoACD is native code that may crash, so that it runs in another process, which is started again after the part at
    which it has ended.

    Raises
    ------
    MissingPackage
        If there are parts and coacd is not installed.
    """
    if not parts:
        return {}
    if find_spec("coacd") is None:
        raise MissingPackage(
            "Convex pieces need the package coacd: run pip install 'cleave-mesh[robot]', or choose collision=hull."
        )
    found: dict[int, list[Solid]] = {}
    with TemporaryDirectory(prefix="cleave-") as name:
        folder = Path(name)
        for part, shape in parts.items():
            _write(folder, part, shape, options)
        waiting = list(parts)
        while waiting:
            command = [sys.executable, "-P", decomposition.__file__, name, *map(str, waiting)]
            with _ONE_AT_A_TIME:
                subprocess.run(command, check=False, stdin=subprocess.DEVNULL, capture_output=True)
            done = [part for part in waiting if (folder / PIECES.format(part)).exists()]
            found |= {part: _read(folder, part, parts[part]) for part in done}
            waiting = waiting[len(done) + 1 :]
    return {part: pieces for part, pieces in found.items() if pieces}


def _write(folder: Path, part: int, shape: Solid, options: RobotOptions) -> None:
    centre, scale = _frame(shape)
    np.savez(folder / PART.format(part), vertices=(shape.vertices - centre) / scale, faces=shape.faces)
    chosen = {"threshold": options.concavity, "max_convex_hull": options.pieces, **_SEARCH}
    (folder / OPTIONS.format(part)).write_text(json.dumps(chosen))


def _read(folder: Path, part: int, shape: Solid) -> list[Solid]:
    centre, scale = _frame(shape)
    with np.load(folder / PIECES.format(part)) as arrays:
        hulls = [convex_hull(points * scale + centre) for points in arrays.values() if np.isfinite(points).all()]
    return [hull for hull in hulls if hull is not None]


def _frame(shape: Solid) -> tuple[FloatArray, float]:
    """The centre (3,) and the longest side of a part."""
    low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
    return 0.5 * (low + high), float((high - low).max())
