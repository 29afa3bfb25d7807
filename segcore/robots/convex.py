"""Convex pieces of a part, by which simulators find collisions.

References
----------
X. Wei, M. Liu, Z. Ling, H. Su, Approximate convex decomposition for 3D meshes with collision-aware concavity and tree
search, ACM Transactions on Graphics 41(4), 2022.
"""

from threading import Lock
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from segcore.arrays import FloatArray
from segcore.errors import MissingPackage
from segcore.robots.masses import Solid
from segcore.robots.options import RobotOptions

_CONVEX = 0.95  # of the volume of its hull, from which a part is its hull; set by hand
# Of the search of CoACD, set by hand: its defaults take ten times as long or more.
_SEARCH = {"mcts_iterations": 10, "mcts_nodes": 6, "mcts_max_depth": 1, "resolution": 500, "preprocess_resolution": 30}
_LOCK = Lock()  # CoACD has states of the whole process, and uses all cores anyway


def library() -> Any:
    """Return coacd.

    Raises
    ------
    MissingPackage
        If it is not installed.
    """
    try:
        import coacd
    except ImportError:
        raise MissingPackage(
            "Convex pieces need the package coacd: run pip install 'cleave-mesh[robot]', or choose collision=hull."
        ) from None
    return coacd


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


def convex_pieces(part: Solid, hull: Solid, volume: float | None, options: RobotOptions) -> list[Solid]:
    """Return convex pieces that cover a part: its hull, if the part fills that.

    Parameters
    ----------
    volume : of the part over that of its hull; None if it is not known.

    Raises
    ------
    MissingPackage
        If coacd is needed and not installed.
    """
    if volume is not None and volume >= _CONVEX:
        return [hull]
    coacd = library()
    low, high = part.vertices.min(axis=0), part.vertices.max(axis=0)
    centre, scale = 0.5 * (low + high), float((high - low).max())
    with _LOCK:
        coacd.set_log_level("off")
        found = coacd.run_coacd(
            coacd.Mesh((part.vertices - centre) / scale, part.faces),
            threshold=options.concavity,
            max_convex_hull=options.pieces,
            **_SEARCH,
        )
    hulls = [convex_hull(np.asarray(vertices) * scale + centre) for vertices, _ in found]
    return [piece for piece in hulls if piece is not None] or [hull]
