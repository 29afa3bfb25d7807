"""The line about the number of segments that `cleave segment` and `cleave convert` print."""

import numpy as np

from segcore.hierarchy import Hierarchy
from segcore.levels import Fineness

_MOST_LINES = 8  # of segments; set by hand


def level_summary(hierarchy: Hierarchy, segments: int, fineness: Fineness) -> str:
    """Return the number of segments, who has chosen it, and the number at which the hierarchy ends and why."""
    chosen = "chosen automatically" if fineness.is_automatic else "as requested"
    return f"{segments} segment{'s' if segments != 1 else ''}, {chosen}; {_end(hierarchy)}"


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
