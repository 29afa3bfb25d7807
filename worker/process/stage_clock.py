"""How long each stage of a job takes."""

import time
from collections.abc import Callable

OnProgress = Callable[[str, float], None]


class StageClock:
    """An ``on_progress`` that passes everything on, and measures the time from one stage to the next."""

    def __init__(self, on_progress: OnProgress, now_s: Callable[[], float] = time.monotonic) -> None:
        self._on_progress = on_progress
        self._now_s = now_s
        self._stage: str | None = None
        self._since_s = 0.0
        self._seconds: dict[str, float] = {}

    def __call__(self, stage: str, fraction: float) -> None:
        self.begin(stage)
        self._on_progress(stage, fraction)

    def begin(self, stage: str) -> None:
        """Begin a stage that is not worth telling, or go on with it."""
        if stage != self._stage:
            self.stop()
            self._stage, self._since_s = stage, self._now_s()

    def stop(self) -> dict[str, float]:
        """The seconds of every stage so far; none goes on."""
        if self._stage is not None:
            self._seconds[self._stage] = self._seconds.get(self._stage, 0.0) + self._now_s() - self._since_s
            self._stage = None
        return dict(self._seconds)
