"""Progress of a segmentation as a fraction of its work, estimated from the size of the mesh."""

from collections.abc import Callable
from math import ceil, log

OnProgress = Callable[[str, float], None]
OnPart = Callable[[float], None]  # called with the fraction of a stage that is done


def report_nothing(_: float) -> None:
    """Ignore the fraction of a stage that is done."""


# Processor seconds of every stage in the order of the work, fixed and per million faces; only their proportions matter.
# Measured on tori and burrs of 20,000, 300,000 and 1,060,000 faces, whose stages begin within 0.06 of their fraction.
_SECONDS = {
    "clean": (0.0, 0.3),
    "affinity": (0.05, 1.25),
    "coarsen": (0.02, 0.65),
    "cut": (0.05, 0.05),
    "label": (0.007, 0.11),
}
STAGES = tuple(_SECONDS)  # in order


_ESTIMATED_FROM_S = 1.0  # before that an estimate would jump with every report; set by hand


def seconds_left(elapsed_s: float, fraction: float) -> int | None:
    """Estimate the seconds that work still takes, rounded up, as if it went on at its mean speed so far.

    Parameters
    ----------
    elapsed_s : seconds since its start.
    fraction : of the work that is done, 0 to 1.

    Returns
    -------
    None in the first second, or if nothing is done.
    """
    if elapsed_s < _ESTIMATED_FROM_S or fraction <= 0.0:
        return None
    return ceil(elapsed_s * (1.0 - min(fraction, 1.0)) / fraction)


class Progress:
    """Reports stages and fractions to a callback, which may end the segmentation by raising an exception."""

    def __init__(self, on_progress: OnProgress, face_count: int) -> None:
        self._on_progress = on_progress
        seconds = {stage: fixed + growing * face_count / 1e6 for stage, (fixed, growing) in _SECONDS.items()}
        total = sum(seconds.values())
        self._share = {stage: one / total for stage, one in seconds.items()}
        stages = list(self._share)
        self._done = 0.0
        self._begin = {stage: sum(self._share[s] for s in stages[:i]) for i, stage in enumerate(stages)}

    def after_splits(self, most: int, done: float) -> None:
        """Report the fraction of ``most`` segments that is done. Later segments are smaller and take less time."""
        self("cut", 1.0 + log(done) / log(most))

    def __call__(self, stage: str, within: float = 0.0) -> None:
        """Report the fraction of a stage that is done, 0 at its start. A stage that is repeated takes nothing back."""
        self._done = max(self._done, min(1.0, self._begin[stage] + within * self._share[stage]))
        self._on_progress(stage, self._done)
