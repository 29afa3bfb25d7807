"""Means over the assets of a set, and over the sets."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from statistics import fmean

from bench.assets.evaluation import AssetResult

# By more than this an automatic result is worse than a trivial method, in 1 - Rand; set by hand.
_CLEARLY_WORSE = 0.005


@dataclass(frozen=True, slots=True)
class Means:
    """Means over some assets, or over some sets."""

    parts: float
    found: float  # automatic number of segments
    given: float  # 1 - Rand
    automatic: float
    given_iou: float
    automatic_iou: float
    best: float
    components: float
    kmeans: float
    flat: float
    mirror: float  # over the symmetric assets; nan if there is none
    cpu_s: float

    @property
    def worse_than_trivial(self) -> bool:
        """Whether the automatic result is clearly worse than the better one of components and k-means."""
        return self.automatic > min(self.components, self.kmeans) + _CLEARLY_WORSE


@dataclass(frozen=True, slots=True)
class SetSummary:
    """The assets of one set."""

    collection: str
    models: int
    halved: int  # assets of which half or fewer of the parts are found
    means: Means


def by_set(results: Sequence[AssetResult]) -> list[SetSummary]:
    """Return one summary for every set, in the order of their first appearance."""
    names = dict.fromkeys(result.collection for result in results)
    return [_summary(name, [result for result in results if result.collection == name]) for name in names]


def over_sets(summaries: Sequence[SetSummary]) -> Means:
    """Return the means over the sets, each with the same weight."""
    names = [field.name for field in fields(Means)]
    return Means(**{name: _mean([getattr(one.means, name) for one in summaries]) for name in names})


def _summary(name: str, results: Sequence[AssetResult]) -> SetSummary:
    means = Means(
        parts=fmean(result.parts for result in results),
        found=fmean(result.automatic.segments for result in results),
        given=fmean(result.given.one_minus_rand for result in results),
        automatic=fmean(result.automatic.one_minus_rand for result in results),
        given_iou=fmean(result.given.iou for result in results),
        automatic_iou=fmean(result.automatic.iou for result in results),
        best=fmean(result.best for result in results),
        components=fmean(result.components for result in results),
        kmeans=fmean(result.kmeans for result in results),
        flat=fmean(result.flat for result in results),
        mirror=_mean([result.mirror for result in results]),
        cpu_s=fmean(result.cpu_s for result in results),
    )
    return SetSummary(name, len(results), sum(result.halved for result in results), means)


def _mean(values: Sequence[float]) -> float:
    defined = [value for value in values if not math.isnan(value)]
    return fmean(defined) if defined else math.nan
