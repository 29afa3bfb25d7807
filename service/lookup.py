"""Jobs as a caller sees them: found by id, described with what the store and the queue know at the moment."""

from collections.abc import Sequence

from cleave.logs import note_job
from segcore.io.result import Segmentation
from service.context import Context
from service.documents import JobDocument, job_document
from service.guard.callers import Caller
from service.problems import JobError, Problem
from worker.jobs.job import Canceled, Failed, Job, Succeeded
from worker.jobs.store.store import UnknownJob


def known_job(context: Context, caller: Caller, job_id: str) -> Job:
    """The record of a job of the caller; others' jobs are not there.

    Raises
    ------
    UnknownJob
        Where there is none.
    Problem
        Where there was one.
    """
    job = context.store.records.job(job_id)
    if job is not None and job.owner == caller.owner:
        note_job(job_id)
        return job
    if context.store.deletions.was_deleted(job_id, caller.owner):
        raise Problem("job_deleted", "This job was deleted with its files: submit the mesh again.")
    raise UnknownJob(job_id)


def describe(context: Context, job: Job) -> JobDocument:
    return describe_all(context, [job])[0]


def describe_all(context: Context, jobs: Sequence[Job]) -> list[JobDocument]:
    """How some jobs are, with one question to the queue."""
    states = context.store.records.states([job.id for job in jobs])
    activities = context.view.activities([job.id for job in jobs if states[job.id].outcome is None])
    return [job_document(job, states[job.id].outcome, states[job.id].attempts, activities.get(job.id)) for job in jobs]


def result_of(context: Context, job: Job) -> Segmentation:
    """The mesh and the hierarchy of a job that succeeded; where there is none, the Problem says why."""
    check_succeeded(context, job)
    return context.results.get(job.id)


def check_succeeded(context: Context, job: Job) -> None:
    """Raise the Problem that says why a job has no result, where it has none."""
    match context.store.records.outcome(job.id):
        case Succeeded():
            return
        case Failed(code=code, message=message):
            raise Problem("job_failed", f"The job failed: {message}", JobError(code=code, message=message))
        case Canceled():
            raise Problem("job_canceled", "The job was canceled and has no result: submit the mesh again.")
        case None:
            raise Problem("not_finished", "The job has not finished: poll it until its status is succeeded.")
