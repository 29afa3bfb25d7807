"""The limit on an owner's jobs in the queue: the others wait in the store, in the order of their submission."""

from cleave.settings import Settings
from worker.jobs.job import Job
from worker.jobs.queue.queue import JobQueue
from worker.jobs.size_class import size_class
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
    """Return the oldest jobs of an owner that are not in the queue, as many as the limit allows."""
    unfinished = store.pending.of(owner)
    held = queue.held(unfinished)
    outside = [job_id for job_id in unfinished if job_id not in held]
    jobs = (store.records.job(job_id) for job_id in outside[: max(0, most - len(held))])
    return [job for job in jobs if job is not None]


def may_wait_outside(owner_of: dict[str, str | None], held: set[str], most: int | None) -> set[str]:
    """Return the unfinished jobs that may be absent from the queue, because their owners have reached the limit.

    Parameters
    ----------
    owner_of : the owners of all unfinished jobs, oldest job first.
    held : the jobs that are in the queue or run.
    most : jobs of an owner in the queue at a time; None for no limit.
    """
    if most is None:
        return set()
    room: dict[str | None, int] = {}
    for job_id in held:
        owner = owner_of.get(job_id)
        room[owner] = room.get(owner, most) - 1
    outside: set[str] = set()
    for job_id, owner in owner_of.items():
        if job_id not in held:
            room[owner] = room.get(owner, most) - 1
            if room[owner] < 0:
                outside.add(job_id)
    return outside
