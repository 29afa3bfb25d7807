"""Acceptance of a job: its mesh and its index entries are written first, and its record last.

All of them are synchronised to the disk together, while the job may run already. After a crash of the machine before
the end of that, of a job that was not accepted, some of them may be absent.
"""

from collections.abc import Callable
from pathlib import Path

from worker.jobs.job import Job
from worker.jobs.objects.interface import ObjectStorage, StoreError
from worker.jobs.store.index import JobIndex, timeline_key
from worker.jobs.store.layout import RECORD, entry_name, job_key, mesh_name
from worker.jobs.store.outbox import Delivery, Outbox
from worker.jobs.store.pending import PendingJobs, marker_key
from worker.jobs.store.records import Records


class JobExists(Exception):  # noqa: N818
    """The store has a job of this id already."""


class Acceptance:
    def __init__(self, objects: ObjectStorage, pending: PendingJobs, outbox: Outbox) -> None:
        self._objects = objects
        self._pending = pending
        self._outbox = outbox
        self._records = Records(objects)
        self._index = JobIndex(objects)

    def accept(self, job: Job, mesh: Path, begin: Callable[[], None]) -> None:
        """Store a job and its mesh, a file that may be moved; ``begin`` is called as soon as the job can run.

        Raises
        ------
        JobExists
            If there is a job of this id already; it is accepted, and not changed.
        """
        self._refuse_existing(job.id)
        try:
            self._prepare(job, mesh)
            is_new = self._records.create_job(job)
        except StoreError:
            raise  # the job may be accepted nevertheless; the janitor finds out and cleans up
        except OSError:
            self._clean_up(job)
            raise
        if not is_new:
            self._clean_up(job)
            self._refuse_existing(job.id)
            raise JobExists(job.id)  # and was deleted meanwhile
        begin()
        self._objects.sync(_keys(job))

    def _refuse_existing(self, job_id: str) -> None:
        """Raise JobExists if there is a job of an id, once it is accepted: its own request may not have ended yet."""
        job = self._records.job(job_id)
        if job is not None:
            self._objects.sync(_keys(job))
            raise JobExists(job_id)

    def _prepare(self, job: Job, mesh: Path) -> None:
        """Write everything but the record; the marker comes first, so that the rest can be found after a crash."""
        self._pending.add(job)
        self._objects.put_file(job_key(job.id, mesh_name(job)), mesh)
        self._index.add(job)
        if job.webhook_url is not None:
            self._outbox.put(job.id, Delivery())

    def _clean_up(self, job: Job) -> None:
        """Remove what was prepared for a job that is not accepted, unless it belongs to another job of this id."""
        accepted = self._records.job(job.id)
        if accepted is None or mesh_name(accepted) != mesh_name(job):
            self._objects.delete(job_key(job.id, mesh_name(job)))
        if accepted is None or entry_name(accepted) != entry_name(job):
            self._index.remove(job)
            self._pending.remove(job)
        if accepted is None:
            self._outbox.remove(job.id)


def _keys(job: Job) -> list[str]:
    """Return the keys of everything that belongs to a new job, except its outbox, which is durable."""
    record, mesh = job_key(job.id, RECORD), job_key(job.id, mesh_name(job))
    return [mesh, record, marker_key(job), timeline_key(job.owner, entry_name(job))]
