"""The stored file of a job, for outputs that keep everything that it has."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from segcore.errors import CleaveError, InvalidParameters
from service.context import Context
from service.problems import Problem
from worker.jobs.store.store import UnknownJob
from worker.process.perform import read_limits

if TYPE_CHECKING:
    from segcore.io import Original

ORIGINAL_PROBLEMS = ("input_lost", "input_changed")  # codes that stored_original raises


@contextmanager
def stored_original(context: Context, job_id: str) -> "Iterator[Original]":
    """Open the file that was sent for a job.

    Raises
    ------
    UnknownJob
        If the job was deleted.
    Problem
        If the store no longer has the file, or the file cannot be divided as the job has segmented it, because an
        earlier version has read it in another way.
    """
    from segcore.io import Original

    job = context.store.records.job(job_id)
    if job is None:
        raise UnknownJob(job_id)
    try:
        file = context.store.open_mesh(job_id)
    except FileNotFoundError:
        raise Problem("input_lost") from None
    with file:
        try:
            yield Original(file, job.mesh_format, read_limits(context.settings))
        except InvalidParameters:
            raise
        except CleaveError as error:
            raise Problem("input_changed", str(error)) from error
