"""The store of the jobs of an installation: the only record of them that counts, in a folder or a bucket.

A job can run when its record is created, after everything else that belongs to it, and is finished when its manifest
is created, which only the first writer can do. Both are on the disk when the method that creates them returns.
``worker.jobs.store.layout`` lists the names of the objects.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import BinaryIO

from worker.jobs.attempts import Attempt
from worker.jobs.job import Job, Outcome, Succeeded, now
from worker.jobs.objects.file_cache import FileCache
from worker.jobs.objects.interface import ObjectStorage
from worker.jobs.store.acceptance import Acceptance
from worker.jobs.store.batches import BatchStore
from worker.jobs.store.computed import ComputedIndex
from worker.jobs.store.deletion import Deletions
from worker.jobs.store.ended import EndedIndex
from worker.jobs.store.index import JobIndex
from worker.jobs.store.installation_secret import InstallationSecret
from worker.jobs.store.layout import MANIFEST, MESH, job_key, mesh_name
from worker.jobs.store.outbox import Outbox
from worker.jobs.store.pages import JobPage, read_page
from worker.jobs.store.pending import PendingJobs
from worker.jobs.store.queued_edits import QueuedEdits
from worker.jobs.store.records import Records
from worker.jobs.store.records import UnknownJob as UnknownJob
from worker.jobs.store.results import ResultFiles
from worker.jobs.store.revisions import Revisions
from worker.jobs.store.spool import Spool
from worker.jobs.store.upload import MeshUpload


class JobStore:
    """The jobs of an installation, shared by all processes and machines that use the same storage.

    Each part is an attribute; the methods are the operations that concern several parts. Operations that change a job
    or read its result raise UnknownJob if there is no such job, or no longer.

    Parameters
    ----------
    objects : the storage.
    spool : files of this machine on their way into the storage.
    cache : results that were fetched from a remote storage; None for no cache.
    """

    def __init__(self, objects: ObjectStorage, spool: Spool, cache: FileCache | None = None) -> None:
        self.objects = objects
        self.spool = spool
        self.records = Records(objects)
        self.results = ResultFiles(objects, self.records, spool, cache)
        self.revisions = Revisions(objects, self.records)
        self.queued_edits = QueuedEdits(objects, self.records)
        self.pending = PendingJobs(objects, self._record_end)
        self.index = JobIndex(objects)
        self.ended = EndedIndex(objects)
        self.computed = ComputedIndex(objects)
        self.outbox = Outbox(objects)
        self.batches = BatchStore(objects)
        self.deletions = Deletions(objects)
        self.secret = InstallationSecret(objects)
        self._acceptance = Acceptance(objects, self.pending, self.outbox)

    def accept(self, job: Job, upload: MeshUpload, begin: Callable[[], None] = lambda: None) -> None:
        """Accept a job: once this returns, the job will be finished even if the queue or the power is lost.

        ``begin`` is called as soon as the job can run, before that is so.

        Raises
        ------
        JobExists
            If there is a job of this id already; it is not changed.
        """
        upload.close()
        self._acceptance.accept(job, upload.path, begin)

    def finish_as_before(self, job: Job) -> bool:
        """Give a job the result of an earlier one of its owner with the same mesh, parameters and software, if any.

        Return False if there is no such result.
        """
        for earlier in self.computed.equal_to(job):
            outcome = self.records.outcome(earlier)
            if isinstance(outcome, Succeeded):
                with suppress(FileNotFoundError):  # it is being deleted
                    self.results.share(earlier, job.id)
                    self.finish(job.id, replace(outcome, finished_at=now()))
                    return True
        return False

    def page(self, owner: str | None, cursor: str | None, limit: int) -> JobPage:
        """Return the jobs of an owner from a cursor on, newest first."""
        return read_page(self.index, self.records, owner, cursor, limit)

    def open_mesh(self, job_id: str) -> BinaryIO:
        """Open the mesh file of a job.

        Raises
        ------
        FileNotFoundError
            If the store has lost it.
        """
        job = self.records.job(job_id)
        try:
            return self.objects.open(job_key(job_id, MESH if job is None else mesh_name(job)))
        except FileNotFoundError:
            return self.objects.open(job_key(job_id, MESH))

    def begin_attempt(self, job_id: str, worker: str) -> Attempt:
        """Count one more run of a job, before it starts."""
        attempt = self.records.add_attempt(job_id, worker)
        self.spool.remove_results(job_id)
        return attempt

    def finish(self, job_id: str, outcome: Outcome, announce: Callable[[], None] = lambda: None) -> Outcome:
        """Give a job its outcome, unless it has one; return the outcome that it has now.

        ``announce`` is called as soon as the outcome can be read. If the machine crashes before this returns, the job
        may have none again; another run then has the same result.
        """
        job = self.records.job(job_id)
        if job is None:
            raise UnknownJob(job_id)
        standing = self.records.write_outcome(job_id, outcome)
        announce()
        self.objects.sync([job_key(job_id, MANIFEST)])
        if isinstance(standing, Succeeded):
            with suppress(OSError):  # only an optimisation is lost
                self.computed.add(job)
                self.records.require(job_id, lambda: self.computed.remove(job))
        with suppress(OSError):  # a check of the marker does this later
            self._add_end(job, standing)
            self.pending.remove(job)
        return standing

    def delete(self, job_id: str) -> None:
        """Remove a job and all its files; it disappears at once, and only that it existed is remembered."""
        job = self.records.job(job_id)
        if job is None:
            raise UnknownJob(job_id)
        self.deletions.begin(job)
        self._remove(job)

    def finish_deletions(self, begun_s: float) -> None:
        """Complete the deletions that were begun longer ago than this by processes that died meanwhile."""
        for job in self.deletions.begun_before(begun_s):
            self._remove(job)

    def check_writable(self) -> None:
        """Raise an OSError if jobs cannot be written here."""
        self.objects.check_writable()
        with self.spool.begin_upload() as probe:
            probe.write(b"?")
            probe.close()

    def _record_end(self, job_id: str) -> None:
        """Add a job to the index of ended jobs, if it has an outcome, unless it was deleted."""
        job, outcome = self.records.job(job_id), self.records.outcome(job_id)
        if job is not None and outcome is not None:
            self._add_end(job, outcome)

    def _add_end(self, job: Job, outcome: Outcome) -> None:
        key = self.ended.key_of(job, outcome)
        self.ended.add(key)
        if not self.records.has_job(job.id):
            self.ended.remove(key)

    def _remove(self, job: Job) -> None:
        self.deletions.remove_record(job)
        outcome = self.records.outcome(job.id)
        if outcome is not None:  # the key is made of the outcome and the result, which are removed after the entry
            self.ended.remove(self.ended.key_of(job, outcome))
        self.deletions.remove_files(job)
        self.results.drop(job.id)
        self.index.remove(job)
        self.computed.remove(job)
        self.pending.remove(job)
        self.outbox.remove(job.id)
        self.deletions.end(job)
