"""What the workers and the janitor have done, counted in Redis, from where every service tells it to Prometheus.

One hash; a counter is a field. Whoever adds does not wait and does not fail: where Redis is gone a count is lost, and
where it was wiped all begin again at 0, which counters of Prometheus may.
"""

import logging
from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass

from redis import Redis

from worker.jobs.attempts import Cause
from worker.jobs.job import Job, Outcome, Succeeded
from worker.jobs.queue.connection import QueueError, text_of

log = logging.getLogger("cleave.tallies")

BOUNDS_S = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0)

_KEY = "cleave:tallies"
_SEPARATOR = "|"
_SUM = "sum"


@dataclass(frozen=True, slots=True)
class Durations:
    """A histogram: how many durations were at most as long as each bound, and all of them together."""

    counts: tuple[float, ...]  # (len(BOUNDS_S) + 1,), of which the last counts those beyond all bounds; not cumulative
    sum_s: float


class JobCounters:
    """Counters that the processes of an installation share: a name and the values of its labels."""

    def __init__(self, connection: Redis) -> None:
        self._connection = connection

    def job_ended(self, job: Job, outcome: Outcome, stage_seconds: Mapping[str, float]) -> None:
        """A work-horse has given a job its outcome."""
        code = "" if isinstance(outcome, Succeeded) else getattr(outcome, "code", "")
        amounts: dict[tuple[str, ...], float] = {("finished", outcome.status, code): 1.0}
        if isinstance(outcome, Succeeded):
            amounts["faces",] = float(outcome.faces)
        amounts |= _duration(("job",), (outcome.finished_at - job.created_at).total_seconds())
        for stage, seconds in stage_seconds.items():
            amounts |= _duration(("stage", stage), seconds)
        self._add(amounts)

    def job_given_up(self, code: str) -> None:
        """A job has had all its attempts."""
        self._add({("finished", "failed", code): 1.0})

    def job_canceled(self) -> None:
        """A client no longer wants a job that had not ended."""
        self._add({("finished", "canceled", ""): 1.0})

    def attempt_lost(self, cause: Cause) -> None:
        """A run of a job ended without an outcome."""
        self._add({("lost", cause): 1.0})

    def job_recovered(self) -> None:
        """The janitor has put a job back that the queue had lost."""
        self._add({("recovered",): 1.0})

    def store_failed(self, process: str) -> None:
        """A process could not read or write the store."""
        self._add({("store_errors", process): 1.0})

    def counts(self) -> dict[tuple[str, ...], float]:
        """Every counter that is not 0.

        Raises
        ------
        QueueError
            Where Redis does not answer.
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
    """A histogram out of the counters."""
    inside = tuple(counts.get((*name, str(bound)), 0.0) for bound in range(len(BOUNDS_S) + 1))
    return Durations(inside, counts.get((*name, _SUM), 0.0))


def _duration(name: tuple[str, ...], seconds: float) -> dict[tuple[str, ...], float]:
    return {(*name, str(bisect_left(BOUNDS_S, seconds))): 1.0, (*name, _SUM): max(0.0, seconds)}
