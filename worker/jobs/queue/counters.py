"""Counters of finished jobs, lost attempts and durations in Redis, which every service exports to Prometheus.

They are the fields of one hash. Counting never fails: if Redis does not answer, a count is lost, and if Redis loses its
data, all counters restart at 0, which Prometheus expects of counters.
"""

import logging
from bisect import bisect_left
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass

from redis import Redis

from worker.jobs.attempts import Cause
from worker.jobs.job import Job, Outcome, Succeeded
from worker.jobs.queue.connection import QueueError, text_of

log = logging.getLogger("cleave.counters")

# Upper bounds of the histograms, about two to a decade: from the fastest stages to CLEAVE_JOB_TIMEOUT_S (3600 s). They
# are part of the metrics, so other bounds would break dashboards.
BOUNDS_S = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0)

_KEY = "cleave:tallies"  # the name in installations that are in use
_STORED_KEY = "cleave:stored"
_SEPARATOR = "|"
_SUM = "sum"


@dataclass(frozen=True, slots=True)
class Durations:
    """A histogram of durations."""

    counts: tuple[float, ...]  # (len(BOUNDS_S) + 1,) durations per bound, not cumulative; the last are above all bounds
    sum_s: float


@dataclass(frozen=True, slots=True)
class Stored:
    """The ended jobs in the store, and the size of their meshes and results."""

    jobs: int
    size_bytes: int


class JobCounters:
    """Counters that all processes of an installation share, each named by a tuple of a name and label values."""

    def __init__(self, connection: Redis) -> None:
        self._connection = connection

    def job_ended(self, job: Job, outcome: Outcome, stage_seconds: Mapping[str, float]) -> None:
        """Count a job to which a work-horse has given its outcome."""
        code = "" if isinstance(outcome, Succeeded) else getattr(outcome, "code", "")
        amounts: dict[tuple[str, ...], float] = {("finished", outcome.status, code): 1.0}
        if isinstance(outcome, Succeeded):
            amounts["faces",] = float(outcome.faces)
        amounts |= _duration(("job",), (outcome.finished_at - job.created_at).total_seconds())
        for stage, seconds in stage_seconds.items():
            amounts |= _duration(("stage", stage), seconds)
        self._add(amounts)

    def job_given_up(self, code: str) -> None:
        """Count a job that failed after all its attempts."""
        self._add({("finished", "failed", code): 1.0})

    def job_canceled(self) -> None:
        """Count a job that was canceled before its end."""
        self._add({("finished", "canceled", ""): 1.0})

    def attempt_lost(self, cause: Cause) -> None:
        """Count a run of a job that ended without an outcome."""
        self._add({("lost", cause): 1.0})

    def job_recovered(self) -> None:
        """Count a job that the queue had lost and the janitor has enqueued again."""
        self._add({("recovered",): 1.0})

    def jobs_counted(self, stored: Stored) -> None:
        """Note how many jobs there are; a failure is ignored, as the next count will be noted."""
        with suppress(QueueError):
            self._connection.hset(_STORED_KEY, mapping={"jobs": stored.jobs, "size_bytes": stored.size_bytes})

    def stored(self) -> Stored | None:
        """Return the jobs in the store when they were last counted; None if they never were.

        Raises
        ------
        QueueError
            If Redis does not answer.
        """
        values = {text_of(name): int(value) for name, value in self._connection.hgetall(_STORED_KEY).items()}
        return Stored(**values) if values else None

    def store_failed(self, process: str) -> None:
        """Count a failed read or write of the store by a process."""
        self._add({("store_errors", process): 1.0})

    def counts(self) -> dict[tuple[str, ...], float]:
        """Return every counter that is not 0.

        Raises
        ------
        QueueError
            If Redis does not answer.
        """
        fields = self._connection.hgetall(_KEY).items()
        return {tuple(text_of(name).split(_SEPARATOR)): float(value) for name, value in fields}

    def _add(self, amounts: Mapping[tuple[str, ...], float]) -> None:
        try:
            with self._connection.pipeline(transaction=False) as pipeline:
                for name, amount in amounts.items():
                    pipeline.hincrbyfloat(_KEY, _SEPARATOR.join(name), amount)
                pipeline.execute()
        except QueueError as error:
            log.debug("not counted: %s", error)


def durations(counts: Mapping[tuple[str, ...], float], name: tuple[str, ...]) -> Durations:
    """Return a histogram from the counters."""
    inside = tuple(counts.get((*name, str(bound)), 0.0) for bound in range(len(BOUNDS_S) + 1))
    return Durations(inside, counts.get((*name, _SUM), 0.0))


def _duration(name: tuple[str, ...], seconds: float) -> dict[tuple[str, ...], float]:
    return {(*name, str(bisect_left(BOUNDS_S, seconds))): 1.0, (*name, _SUM): max(0.0, seconds)}
