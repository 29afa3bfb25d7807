"""Attempts: the runs of a job by workers, and the failure of a job that has used all of them."""

from dataclasses import dataclass
from datetime import datetime
from typing import Literal, TypeAlias

from segcore.errors import InvalidMesh, InvalidParameters, LimitExceeded, UnsupportedFormat
from worker.jobs.job import Failed, now

Cause: TypeAlias = Literal["worker_lost", "out_of_memory", "timed_out", "file_too_large", "internal_error"]

FAILURES: dict[Cause, str] = {
    "worker_lost": "The worker died while it ran this job, {attempts} times in a row: simplify the mesh, or ask the "
    "operator to check the log of the workers.",
    "out_of_memory": "The job needs more memory than this installation gives it: send a mesh of fewer faces.",
    "timed_out": "The job runs longer than this installation allows: send a mesh of fewer faces.",
    "file_too_large": "The job writes a larger file than this installation allows: send a mesh of fewer faces.",
    "internal_error": "The job stopped at an internal error, {attempts} times in a row: ask the operator to check "
    "the log of the workers.",
}
INPUT_LOST = "input_lost"
# Every code of Failed.
FAILURE_CODES = (
    *(error.code for error in (InvalidMesh, UnsupportedFormat, InvalidParameters, LimitExceeded)),
    INPUT_LOST,
    *FAILURES,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Attempt:
    """One run of a job by a worker."""

    number: int  # 1, 2, ...
    worker: str
    started_at: datetime  # UTC
    ended_at: datetime | None = None  # None while it runs, and for ever if the worker died during the run
    cause: Cause | None = None  # why it ended without an outcome


def exhausted(attempts: list[Attempt], max_attempts: int) -> Failed | None:
    """Return the failure of a job that has had all its attempts, with the cause of the last; None if it may run again.

    An attempt without a cause ended with its worker.
    """
    if len(attempts) < max_attempts:
        return None
    code: Cause = attempts[-1].cause or "worker_lost"
    return Failed(finished_at=now(), code=code, message=FAILURES[code].format(attempts=len(attempts)))
