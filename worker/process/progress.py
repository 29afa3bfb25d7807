"""How far a running job is, told to the queue now and then."""

import time

from segcore.progress import STAGES as SEGMENTATION_STAGES
from worker.jobs.queue.queue import JobQueue, Progress, QueueError

STAGES = ("reading", *SEGMENTATION_STAGES, "storing")  # of a job, in order
REPORTED_STAGES = STAGES[:-1]  # to the queue; storing a result is only measured

_INTERVAL_S = 0.25
_PAUSE_AFTER_ERROR_S = 5.0


class ProgressReporter:
    """An ``on_progress`` for one job. It never fails and hardly ever waits: progress is worth less than the work."""

    def __init__(self, queue: JobQueue, job_id: str) -> None:
        self._queue = queue
        self._job_id = job_id
        self._next_at = 0.0

    def __call__(self, stage: str, fraction: float) -> None:
        if time.monotonic() < self._next_at:
            return
        try:
            self._queue.publish(self._job_id, Progress(stage, fraction))
            self._next_at = time.monotonic() + _INTERVAL_S
        except QueueError:
            self._next_at = time.monotonic() + _PAUSE_AFTER_ERROR_S
