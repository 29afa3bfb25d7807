"""What an entry of the queue may say: one thing."""

from rq.exceptions import DeserializationError
from rq.job import Job as Entry

from worker.jobs.job import is_job_id
from worker.jobs.queue.queue import TASK


def is_allowed(entry: Entry) -> bool:
    """Whether an entry is what JobQueue.enqueue makes; whoever can write to Redis can make others."""
    try:
        return (
            is_job_id(entry.id)
            and (entry.func_name, entry.instance) == (TASK, None)
            and (list(entry.args), dict(entry.kwargs)) == ([entry.id], {})
        )
    except (DeserializationError, TypeError, ValueError):
        return False
