"""The printed report of a run on the authored assets, and the same as JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from bench.assets.evaluation import AssetResult
from bench.assets.summary import Means, by_set, over_sets
from bench.documents import save_json
from bench.text import format_table, number

FORMAT = "cleave-assets-1"
_WEIGHTING = (
    "given, automatic, best level, components, k-means: 1-Rand by area; IoU: mean over the parts after matching.\n"
    "Every figure is the mean over the models of a set; the last row is the mean over the sets."
)
_HEADER = [
    "set",
    "models",
    "parts",
    "found",
    "halved",
    "given",
    "automatic",
    "given IoU",
    "autom. IoU",
    "best level",
    "components",
    "k-means",
    "flat",
    "mirror",
    "CPU s",
]


def render(results: Sequence[AssetResult]) -> str:
    """Return the table and the lines below it as text."""
    sets = by_set(results)
    mean = over_sets(sets)
    halved = sum(one.halved for one in sets)
    rows = [_row(one.collection, one.models, one.halved, one.means) for one in sets]
    rows.append(_row("mean over sets", len(results), halved, mean))
    worse = [one.collection for one in sets if one.means.worse_than_trivial]
    return "\n".join(
        [
            f"Authored assets: {len(results)} models of {len(sets)} sets.",
            _WEIGHTING,
            "",
            format_table(_HEADER, rows, rules=(len(sets),)),
            "",
            f"Half or fewer of the parts found: {halved} of {len(results)} models.",
            f"Sets with an automatic result worse than components or k-means by more than 0.005: {len(worse)} of "
            f"{len(sets)}{': ' if worse else ''}{', '.join(worse)}.",
            f"Groups of congruent shells that are not cut alike: {sum(result.unlike for result in results)} of "
            f"{sum(result.repeats for result in results)}.",
        ]
    )


def save(path: Path, results: Sequence[AssetResult], settings: Mapping[str, object]) -> None:
    """Write the settings, the means and the results of all models as JSON; an undefined value is null.

    Raises
    ------
    BenchmarkError
        If the file cannot be written.
    """
    sets = by_set(results)
    document = {
        "format": FORMAT,
        **settings,
        "mean": asdict(over_sets(sets)),
        "sets": [asdict(one) for one in sets],
        "models": [asdict(result) for result in results],
    }
    save_json(path, document)


def _row(name: str, models: int, halved: int, means: Means) -> list[str]:
    scores = [means.given, means.automatic, means.given_iou, means.automatic_iou]
    scores += [means.best, means.components, means.kmeans, means.flat, means.mirror]
    counts = [str(models), number(means.parts, 1), number(means.found, 1), str(halved)]
    return [name, *counts, *map(number, scores), number(means.cpu_s, 2)]
