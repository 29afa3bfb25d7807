"""The limit on an owner's jobs in the queue: the oldest belong there, and the others wait in the store."""

from collections import Counter
from collections.abc import Iterable

from cleave.settings import Settings
from worker.jobs.job import Job
from worker.jobs.queue.queue import JobQueue
from worker.jobs.size_class import size_class
from worker.jobs.store.pending import Marker
from worker.jobs.store.store import JobStore


def admit(store: JobStore, queue: JobQueue, settings: Settings, owner: str | None, new: Job | None = None) -> None:
    """Enqueue jobs of an owner up to ``key_max_running_jobs``; to be called after a job is accepted and after one ends.

    Without a limit only the new job is enqueued. Two concurrent calls may enqueue one job more than the limit.
    """
    if settings.key_max_running_jobs is not None:
        admitted = _next_of(store, queue, owner, settings.key_max_running_jobs)
    else:
        admitted = [] if new is None else [new]
    for job in admitted:
        queue.enqueue(job.id, size_class(job, settings.large_job_bytes))


def _next_of(store: JobStore, queue: JobQueue, owner: str | None, most: int) -> list[Job]:
    """Return those of an owner's oldest unfinished jobs, as many as the limit allows, that are not in the queue."""
    oldest = store.pending.oldest_of(owner, most)
    held = queue.held(oldest)
    jobs = (store.records.job(job_id) for job_id in oldest if job_id not in held)
    return [job for job in jobs if job is not None]


def belonging_in_queue(markers: Iterable[Marker], most: int | None) -> list[Marker]:
    """Return the markers of the jobs that must be in the queue or run: the oldest ones of each owner.

    Parameters
    ----------
    markers : of all unfinished jobs, oldest first.
    most : jobs of an owner in the queue at a time; None for no limit.
    """
    if most is None:
        return list(markers)
    number: Counter[str | None] = Counter()
    oldest = []
    for marker in markers:
        number[marker.owner] += 1
        if number[marker.owner] <= most:
            oldest.append(marker)
    return oldest
