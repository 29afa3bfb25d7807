"""Progress of a segmentation as a fraction of its work, estimated from the size of the mesh."""

from collections.abc import Callable
from math import log

OnProgress = Callable[[str, float], None]
OnPart = Callable[[float], None]  # called with the fraction of a stage that is done


def report_nothing(_: float) -> None:
    """Ignore the fraction of a stage that is done."""


# Processor seconds of every stage in the order of the work, fixed and per million faces; only their proportions matter.
# The times per million are those of 2,000,000 faces in the section "Scale" of bench/RESULTS.md. The fixed times were
# measured on 20,000 faces before rays and features of cuts became faster: both have fallen to less than half since.
_SECONDS = {
    "clean": (0.0, 0.3),
    "affinity": (0.3, 1.25),
    "coarsen": (0.0, 0.65),
    "cut": (0.36, 0.0),
    "label": (0.0, 0.11),
}
STAGES = tuple(_SECONDS)  # in order


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
