"""Bar charts of the metrics, readable with any kind of colour vision."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError
from bench.princeton.metrics import Scores

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito, Color universal design, 2008: distinct for every kind of colour vision.
COLORS = ("#0072B2", "#D55E00", "#E69F00", "#009E73")
# The title of every panel, and its metrics with their names in the legend.
PANELS: tuple[tuple[str, tuple[tuple[str, str], ...]], ...] = (
    ("Cut discrepancy", (("cut_discrepancy", ""),)),
    ("Hamming distance", (("hamming", ""),)),
    ("1 \N{MINUS SIGN} Rand index", (("one_minus_rand", ""),)),
    ("Consistency error", (("gce", "global"), ("lce", "local"))),
)
_HATCHES = ("", "////")
_LINES = ("-", "--")
_BAR = 0.76  # total thickness of the bars of one method, in distances between methods; set by hand


@dataclass(frozen=True, slots=True)
class Bar:
    """One method in a chart."""

    title: str
    scores: Scores
    group: int  # bars of one group have the same colour


def require_matplotlib(option: str = "--output") -> None:
    """Raise BenchmarkError if matplotlib is not installed; called before the long computations.

    Parameters
    ----------
    option : the option that asks for a picture, for the message.
    """
    if find_spec("matplotlib") is None:
        raise BenchmarkError(f"Charts need matplotlib: pip install matplotlib, or leave {option} out.")


def metric_chart(title: str, bars: Sequence[Bar], people: Scores) -> Figure:
    """Draw one panel for each of the four metrics: a bar for every method, a line for the people."""
    # Not pyplot, which has global state and may open a display.
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 1.6 + 0.72 * len(bars)), layout="constrained")
    figure.suptitle(title)
    panels = figure.subplots(2, 2, sharey=True)
    for axes, (heading, metrics) in zip(panels.flat, PANELS, strict=True):
        _draw_panel(axes, heading, metrics, bars, people)
    panels[0, 0].invert_yaxis()
    return figure


def save_chart(path: Path, figure: Figure) -> None:
    """Write a chart to a PNG file.

    Raises
    ------
    BenchmarkError
        If the file cannot be written.
    """
    try:
        figure.savefig(path, dpi=150, metadata={"Software": None})
    except OSError as error:
        raise BenchmarkError(f"The chart cannot be written to {path}: {error.strerror}.") from error


def _draw_panel(
    axes: Axes, heading: str, metrics: Sequence[tuple[str, str]], bars: Sequence[Bar], people: Scores
) -> None:
    thickness = _BAR / len(metrics)
    for i, (metric, name) in enumerate(metrics):
        places = [row + (i - (len(metrics) - 1) / 2) * thickness for row in range(len(bars))]
        values = [getattr(bar.scores, metric) for bar in bars]
        drawn = axes.barh(
            places,
            values,
            thickness,
            color=[COLORS[bar.group % len(COLORS)] for bar in bars],
            edgecolor="white",
            hatch=_HATCHES[i],
        )
        axes.bar_label(drawn, ["undefined" if math.isnan(v) else f"{v:.3f}" for v in values], padding=3, fontsize=8)
        label = " ".join(["people", name, f"{getattr(people, metric):.3f}"]).replace("  ", " ")
        axes.axvline(getattr(people, metric), color="black", linestyle=_LINES[i], linewidth=1.2, label=label)
    axes.set_title(heading, fontsize=11, loc="left")
    axes.set_yticks(range(len(bars)), [bar.title for bar in bars])
    axes.margins(x=0.14)
    axes.set_xlim(left=0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=8)
