"""How many jobs of an owner are in the queue or run at a time: the others wait in the store, in the order they came."""

from cleave.settings import Settings
from worker.jobs.job import Job
from worker.jobs.queue.queue import JobQueue
from worker.jobs.size_class import size_class
from worker.jobs.store.store import JobStore


def admit(store: JobStore, queue: JobQueue, settings: Settings, owner: str | None, new: Job | None = None) -> None:
    """Let jobs of an owner into the queue as far as there is room: after a job has come, and after one has ended.

    Where there is no limit only the new job is looked at. Two callers at once may let in one too many.
    """
    if settings.key_max_running_jobs is not None:
        admitted = _next_of(store, queue, owner, settings.key_max_running_jobs)
    else:
        admitted = [] if new is None else [new]
    for job in admitted:
        queue.enqueue(job.id, size_class(job, settings.large_job_bytes))


def _next_of(store: JobStore, queue: JobQueue, owner: str | None, most: int) -> list[Job]:
    """The oldest of an owner's jobs that are outside, as many as there is room for."""
    unfinished = store.pending.of(owner)
    held = queue.held(unfinished)
    outside = [job_id for job_id in unfinished if job_id not in held]
    jobs = (store.records.job(job_id) for job_id in outside[: max(0, most - len(held))])
    return [job for job in jobs if job is not None]


def may_wait_outside(owner_of: dict[str, str | None], held: set[str], most: int | None) -> set[str]:
    """Those of the unfinished jobs, oldest first, that the queue need not hold: their owners have enough there."""
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
