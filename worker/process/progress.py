"""Progress of a job: the durations of its stages, and reports from its work-horse through the worker to the queue.

The work-horse does not wait for Redis: it writes reports to its pipe, and the worker publishes them meanwhile.
"""

import os
import time
from collections.abc import Callable
from contextlib import suppress

from segcore.progress import STAGES as SEGMENTATION_STAGES
from worker.jobs.queue.connection import QueueError
from worker.jobs.queue.queue import JobQueue, Progress

STAGES = ("reading", *SEGMENTATION_STAGES, "storing")  # of a job, in order
REPORTED_STAGES = STAGES[:-1]  # to the queue; storing a result is only measured

_INTERVAL_S = 0.25  # between two reports: the shortest at which the API polls for them
_PAUSE_AFTER_ERROR_S = 5.0  # a report to a Redis that hangs takes 1.8 s; set by hand

OnProgress = Callable[[str, float], None]


class ProgressReports:
    """An ``on_progress`` callback that writes reports to a pipe, a line each; one for which it has no room is lost.

    The beginning of a stage is always reported, progress within it at intervals.
    """

    def __init__(self, pipe: int) -> None:
        """``pipe`` must not block."""
        self._pipe = pipe
        self._stage: str | None = None  # that was reported last
        self._next_at = 0.0  # for the same stage

    def __call__(self, stage: str, fraction: float) -> None:
        if stage == self._stage and time.monotonic() < self._next_at:
            return
        with suppress(BlockingIOError, BrokenPipeError):
            os.write(self._pipe, f"{stage} {float(fraction)!r}\n".encode())
        self._stage, self._next_at = stage, time.monotonic() + _INTERVAL_S


class ProgressPublisher:
    """Publishes what a work-horse has reported; errors of Redis are ignored."""

    def __init__(self, queue: JobQueue, job_id: str) -> None:
        self._queue = queue
        self._job_id = job_id
        self._paused_until = 0.0

    def __call__(self, reports: bytes) -> None:
        """Publish the last of some reports, as :class:`ProgressReports` writes them."""
        if time.monotonic() < self._paused_until:
            return
        stage, fraction = reports.splitlines()[-1].decode().split()
        try:
            self._queue.publish(self._job_id, Progress(stage, float(fraction)))
        except QueueError:
            self._paused_until = time.monotonic() + _PAUSE_AFTER_ERROR_S


class StageClock:
    """An ``on_progress`` callback that measures how long each stage takes and calls another callback."""

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
        """Begin a stage without reporting it, unless it is the current one."""
        if stage != self._stage:
            self.stop()
            self._stage, self._since_s = stage, self._now_s()

    def stop(self) -> dict[str, float]:
        """End the current stage; return the seconds of every stage so far."""
        if self._stage is not None:
            self._seconds[self._stage] = self._seconds.get(self._stage, 0.0) + self._now_s() - self._since_s
            self._stage = None
        return dict(self._seconds)
