"""The places of objects on the bed: side by side in rows, each on the bed as it stands."""

from collections.abc import Sequence

import numpy as np

from segcore.arrays import FloatArray

_GAP = 8.0  # mm between objects, set by hand: room for a brim
_WIDTH = 250.0  # mm, of rows if no bed is given


def places_on_plate(boxes: Sequence[FloatArray], width: float) -> FloatArray:
    """(N, 3) what to add to objects with these boxes, each (2, 3) the lowest and the highest corner.

    Rows along x are filled up to the width, deepest objects first. If there are more objects than the bed holds, the
    last rows are behind it.
    """
    width = width if np.isfinite(width) else _WIDTH
    order = sorted(range(len(boxes)), key=lambda k: -np.ptp(boxes[k][:, 1]))
    places = np.zeros((len(boxes), 3))
    x = y = depth = 0.0
    for k in order:
        size = boxes[k][1] - boxes[k][0]
        if x > 0 and x + size[0] > width:
            x, y, depth = 0.0, y + depth + _GAP, 0.0
        places[k] = np.array([x, y, 0.0]) - boxes[k][0]
        x, depth = x + size[0] + _GAP, max(depth, float(size[1]))
    return places
