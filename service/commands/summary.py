"""The line about the number of segments that `cleave segment` and `cleave convert` print."""

import numpy as np

from segcore.hierarchy import Hierarchy
from segcore.levels import Fineness

_NO_CUT = "No cut is good enough by the rule of these parameters: choose a number with --segments, or other parameters."
_MOST_LINES = 8  # of segments; set by hand


def level_summary(hierarchy: Hierarchy, segments: int, fineness: Fineness) -> str:
    """Return the number of segments, who has chosen it, and the number at which the hierarchy ends and why.

    A second line says what to do if the automatic number is one.
    """
    chosen = "chosen automatically" if fineness.is_automatic else "as requested"
    summary = f"{segments} segment{'s' if segments != 1 else ''}, {chosen}; {_end(hierarchy)}"
    return f"{summary}\n{_NO_CUT}" if fineness.is_automatic and segments == 1 < hierarchy.max_segments else summary


def part_lines(hierarchy: Hierarchy, segments: int) -> list[str]:
    """Return a line for each of the largest segments: its label, its share of the area and its number of faces."""
    nodes = hierarchy.segment_nodes(segments)
    area, faces = hierarchy.area[nodes], hierarchy.face_count[nodes]
    total = max(float(area.sum()), float(np.finfo(float).tiny))
    shown = np.argsort(-area, kind="stable")[:_MOST_LINES].tolist()
    lines = [f"  segment {k}: {100 * area[k] / total:.1f} % of the area, {faces[k]} faces" for k in shown]
    left = len(nodes) - len(shown)
    return [*lines, f"  and {left} smaller one{'s' if left > 1 else ''}"] if left else lines


def _end(hierarchy: Hierarchy) -> str:
    most = hierarchy.max_segments
    match hierarchy.limit_reached:
        case True:
            return f"the hierarchy ends at the limit of {most}: raise max_segments for more"
        case False:
            return f"the hierarchy ends at {most}: no sensible cut is left"
        case None:
            return f"1 to {most} are possible"
