"""The entries of the rq queues: what a valid entry contains.

An entry of rq names a Python function. A worker of Cleave never imports a function by that name: it runs one function
and compares the name only, so that write access to Redis is not enough to choose what is run. FUNCTION_NAME is a label
rather than the path of a module. Entries stay valid if modules are renamed, and no other rq worker can run them.

Entries of earlier versions have the name "worker.tasks.perform". A worker drops them like any unknown entry, and no job
is lost: its record is in the store, and the janitor enqueues it again, under the current name, a few seconds later.
The same happens to a current entry that a worker of an earlier version takes during an upgrade.
"""

from rq.exceptions import DeserializationError
from rq.job import Job as Entry

from worker.jobs.job import is_job_id

FUNCTION_NAME = "cleave:segment"


def is_valid(entry: Entry) -> bool:
    """Whether an entry is one that JobQueue.enqueue makes; anyone who can write to Redis can make others."""
    try:
        return (
            is_job_id(entry.id)
            and (entry.func_name, entry.instance) == (FUNCTION_NAME, None)
            and (list(entry.args), dict(entry.kwargs)) == ([entry.id], {})
        )
    except (DeserializationError, TypeError, ValueError):
        return False
