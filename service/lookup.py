"""Jobs and batches of a caller: found by id, and described with the state of the store and the queue."""

from collections import Counter
from collections.abc import Sequence
from typing import Annotated

from fastapi import Path

from cleave.logs import note_job
from segcore.io import Segmentation
from service.context import Context
from service.documents import BatchDocument, BatchedJob, BatchLinks
from service.guard.callers import Caller
from service.job_documents import JobDocument, job_document
from service.mount import public_path
from service.problems import JobError, Problem
from worker.jobs.job import Canceled, Failed, Job, Succeeded
from worker.jobs.store.batches import Batch
from worker.jobs.store.store import UnknownJob

JobId = Annotated[str, Path(description="As in the response to POST /v1/jobs.")]

# Codes of the problems that find_job and check_succeeded raise, and of a missing API key.
JOB_PROBLEMS = ("unauthorized", "job_not_found", "job_deleted")
RESULT_PROBLEMS = (*JOB_PROBLEMS, "not_finished", "job_failed", "job_canceled")


def find_job(context: Context, caller: Caller, job_id: str) -> Job:
    """Return the record of a job of the caller. Jobs of others are not found.

    Raises
    ------
    UnknownJob
        If there is no such job.
    Problem
        If the job was deleted.
    """
    job = context.store.records.job(job_id)
    if job is not None and job.owner == caller.owner:
        note_job(job_id)
        return job
    if context.store.deletions.was_deleted(job_id, caller.owner):
        raise Problem("job_deleted")
    raise UnknownJob(job_id)


def describe(context: Context, job: Job) -> JobDocument:
    """Return the document of a job."""
    document = describe_all(context, [job])[0]
    if document.status != "succeeded":
        return document
    return document.model_copy(update={"revision": context.store.revisions.newest(job.id)})


def describe_all(context: Context, jobs: Sequence[Job]) -> list[JobDocument]:
    """Return the documents of some jobs, with one request to the queue."""
    states = context.store.records.states([job.id for job in jobs])
    activities = context.view.activities([job.id for job in jobs if states[job.id].outcome is None])
    return [
        job_document(job, state.outcome, state.attempts, activities.get(job.id), state.revision)
        for job, state in ((job, states[job.id]) for job in jobs)
    ]


def result_of(context: Context, job: Job) -> Segmentation:
    """Return the mesh and the hierarchy of a job; errors as in :func:`check_succeeded`."""
    check_succeeded(context, job)
    return context.results.get(job.id)


def check_succeeded(context: Context, job: Job) -> Succeeded:
    """Return the outcome of a job that has a result.

    Raises
    ------
    Problem
        If the job has not finished, has failed or was canceled.
    """
    match context.store.records.outcome(job.id):
        case Succeeded() as outcome:
            return outcome
        case Failed(code=code, message=message):
            raise Problem("job_failed", f"The job failed: {message}", JobError(code=code, message=message))
        case Canceled():
            raise Problem("job_canceled")
        case None:
            raise Problem("not_finished")


def face_count(context: Context, job: Job) -> int:
    """Return the number of faces of a job that has a result; errors as of :func:`check_succeeded`."""
    return check_succeeded(context, job).faces


def find_batch(context: Context, caller: Caller, batch_id: str) -> Batch:
    """Return the record of a batch of the caller. Batches of others are not found.

    Raises
    ------
    Problem
        If there is no such batch.
    """
    batch = context.batches.find(batch_id)
    if batch is None or batch.owner != caller.owner:
        raise Problem("batch_not_found", "There is no batch with this id: it was deleted, or the id is wrong.")
    return batch


def jobs_of_batch(context: Context, batch: Batch) -> list[tuple[Job | None, JobDocument | None]]:
    """Return the jobs of a batch in its order, None for deleted ones."""
    found = context.store.records.jobs(batch.job_ids)
    existing = [job for job in found.values() if job is not None]
    documents = {document.id: document for document in describe_all(context, existing)}
    return [(found[job_id], documents.get(job_id)) for job_id in batch.job_ids]


def ended_jobs(context: Context, batch: Batch) -> list[tuple[Job, JobDocument]]:
    """Return the jobs of a finished batch in its order, without deleted ones.

    Raises
    ------
    Problem
        If a job has not ended.
    """
    jobs = [(job, document) for job, document in jobs_of_batch(context, batch) if job and document]
    if any(document.finished_at is None for _, document in jobs):
        raise Problem("not_finished", "Some jobs of the batch have not ended: poll it until its status is finished.")
    return jobs


def describe_batch(context: Context, batch: Batch) -> BatchDocument:
    """Return the document of a batch."""
    documents = [document for _, document in jobs_of_batch(context, batch)]
    path = public_path(f"/v1/batches/{batch.id}")
    return BatchDocument(
        id=batch.id,
        status="finished" if all(one is None or one.finished_at for one in documents) else "running",
        created_at=batch.created_at,
        counts=dict(Counter("deleted" if one is None else one.status for one in documents)),
        jobs=[
            BatchedJob(
                id=job_id,
                file_name=one.input.file_name if one else None,
                status=one.status if one else "deleted",
                progress=one.progress if one else 0.0,
                error=one.error if one else None,
                self=public_path(f"/v1/jobs/{job_id}"),
            )
            for job_id, one in zip(batch.job_ids, documents, strict=True)
        ],
        left_out=batch.left_out,
        links=BatchLinks(self=path, results=f"{path}/results.zip"),
    )
