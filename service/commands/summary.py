"""The line about the number of segments that `cleave segment` and `cleave convert` print."""

from segcore.hierarchy import Hierarchy
from segcore.levels import Fineness


def level_summary(hierarchy: Hierarchy, segments: int, fineness: Fineness) -> str:
    """Return the number of segments, who has chosen it, and the number at which the hierarchy ends and why."""
    chosen = "chosen automatically" if fineness.is_automatic else "as requested"
    return f"{segments} segment{'s' if segments != 1 else ''}, {chosen}; {_end(hierarchy)}"


def _end(hierarchy: Hierarchy) -> str:
    most = hierarchy.max_segments
    match hierarchy.limit_reached:
        case True:
            return f"the hierarchy ends at the limit of {most}: raise max_segments for more"
        case False:
            return f"the hierarchy ends at {most}: no sensible cut is left"
        case None:
            return f"1 to {most} are possible"
