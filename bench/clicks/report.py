"""The printed report of simulated clicks."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from bench.clicks.evaluation import ClickResult, Clicks
from bench.text import format_table

_AFTER = (1, 2, 3, 5, 10)
_HEADER = ["", "parts", *(f"IoU {count}" for count in _AFTER), "clicks until 0.90", "never", "ms first", "ms next"]


def render(results: Sequence[ClickResult]) -> str:
    """Return the tables as text."""
    groups = sorted({result.group for result in results})
    guided = [clicks for result in results for clicks in result.guided]
    growing = [clicks for result in results for clicks in result.growing]
    best = statistics.fmean(iou for result in results for iou in result.best_node)
    rows = [_row(group, [c for r in results if r.group == group for c in r.guided]) for group in groups]
    rows += [_row("all", guided), _row("plain region growing", growing)]
    return "\n".join(
        [
            f"Simulated clicks on {len(guided)} parts above 1 % of the area, of {len(results)} models.",
            "IoU by area after 1, 2, ... clicks; clicks until it is 0.90, 10 if it never is; CPU time of the first and",
            "of the following clicks.",
            "",
            format_table(_HEADER, rows, rules=(len(groups), len(groups) + 1)),
            "",
            f"Best node of the hierarchy: IoU {best:.3f}.",
            f"Making a guide: {1e6 * statistics.fmean(r.guide_cpu_s / r.faces for r in results):.1f} s CPU for each "
            "million faces.",
        ]
    )


def _row(name: str, parts: Sequence[Clicks]) -> list[str]:
    first = [part.cpu_ms[0] for part in parts]
    following = [ms for part in parts for ms in part.cpu_ms[1:]]
    return [
        name,
        str(len(parts)),
        *(f"{statistics.fmean(part.iou[count - 1] for part in parts):.3f}" for count in _AFTER),
        f"{statistics.fmean(part.until_enough for part in parts):.2f}",
        f"{statistics.fmean(max(part.iou) < 0.9 for part in parts):.1%}",
        f"{statistics.fmean(first):.1f}",
        f"{statistics.fmean(following):.1f}" if following else "",
    ]
