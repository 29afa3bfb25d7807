"""How many jobs of an owner are in the queue or run at a time: the others wait in the store, in the order they came."""

from worker.queue import JobQueue
from worker.store import JobStore


def admit(store: JobStore, queue: JobQueue, owner: str | None, most: int | None, job_id: str | None = None) -> None:
    """Let jobs of an owner into the queue as far as there is room: after a job has come, and after one has ended.

    Where there is no limit only ``job_id`` is looked at. Two callers at once may let in one too many.
    """
    if most is None:
        if job_id is not None:
            queue.enqueue(job_id)
        return
    unfinished = store.unfinished_of(owner)
    held = queue.held(unfinished)
    outside = [waiting for waiting in unfinished if waiting not in held]
    for waiting in outside[: max(0, most - len(held))]:
        queue.enqueue(waiting)


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
