"""How a job is taken in: everything that belongs to it first, then the record that makes it a job."""

from contextlib import suppress
from pathlib import Path

from worker.jobs.job import Job
from worker.jobs.objects.interface import ObjectStorage, StoreError
from worker.jobs.store.computed import ComputedIndex
from worker.jobs.store.index import JobIndex
from worker.jobs.store.layout import entry_name, job_key, mesh_name
from worker.jobs.store.outbox import Delivery, Outbox
from worker.jobs.store.pending import PendingJobs
from worker.jobs.store.records import Records


class JobExists(Exception):  # noqa: N818
    """There is a job of this id already."""


class Acceptance:
    def __init__(self, objects: ObjectStorage, pending: PendingJobs, outbox: Outbox) -> None:
        self._objects = objects
        self._pending = pending
        self._outbox = outbox
        self._records = Records(objects)
        self._index = JobIndex(objects)
        self._computed = ComputedIndex(objects)

    def accept(self, job: Job, mesh: Path) -> None:
        """Take a job in, with its mesh in a file, which may be gone afterwards.

        Raises
        ------
        JobExists
            Where there is a job of this id already; it stays as it is.
        """
        if self._records.has_job(job.id):
            raise JobExists(job.id)
        try:
            self._prepare(job, mesh)
            is_new = self._records.create_job(job)
        except StoreError:
            raise  # the job may be accepted after all: what is there is left to whoever looks for it later
        except OSError:
            self._clear_away(job)
            raise
        if not is_new:
            self._clear_away(job)
            raise JobExists(job.id)
        with suppress(OSError):  # a hint may be lost
            self._computed.note(job)

    def _prepare(self, job: Job, mesh: Path) -> None:
        """Write what belongs to a job that is not accepted yet; its marker first, by which all of it is found."""
        self._pending.add(job)
        self._objects.put_file(job_key(job.id, mesh_name(job)), mesh)
        self._index.add(job)
        if job.webhook_url is not None:
            self._outbox.put(job.id, Delivery())

    def _clear_away(self, job: Job) -> None:
        """Remove what was prepared for a job that is not accepted, but not what belongs to another of its id."""
        accepted = self._records.job(job.id)
        if accepted is None or mesh_name(accepted) != mesh_name(job):
            self._objects.delete(job_key(job.id, mesh_name(job)))
        if accepted is None or entry_name(accepted) != entry_name(job):
            self._index.remove(job)
            self._pending.remove(job)
        if accepted is None:
            self._outbox.remove(job.id)
