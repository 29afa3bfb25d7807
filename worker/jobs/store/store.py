"""Where jobs live: the truth about every one of them, in whatever place keeps the bytes.

A job is accepted when its record is created, after everything else that belongs to it, and finished when its manifest
is, which only the first writer does. The names of the objects are in ``worker.jobs.store.layout``.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import BinaryIO

from worker.jobs.job import Attempt, Cause, Job, Outcome, Succeeded
from worker.jobs.objects.file_cache import FileCache
from worker.jobs.objects.seam import ObjectStorage
from worker.jobs.store.acceptance import Acceptance
from worker.jobs.store.batches import BatchStore
from worker.jobs.store.computed import ComputedIndex
from worker.jobs.store.deletion import Deletions
from worker.jobs.store.index import JobIndex
from worker.jobs.store.installation_secret import InstallationSecret
from worker.jobs.store.layout import MESH, job_key, mesh_name
from worker.jobs.store.outbox import Outbox
from worker.jobs.store.pages import JobPage, read_page
from worker.jobs.store.pending import PendingJobs
from worker.jobs.store.records import JobState, Records
from worker.jobs.store.records import UnknownJob as UnknownJob
from worker.jobs.store.results import ResultFiles
from worker.jobs.store.spool import Spool
from worker.jobs.store.upload import MeshUpload


class JobStore:
    """The jobs of an installation; processes and machines that share the place of the objects share the jobs.

    What changes a job, or reads its result, raises UnknownJob where there is none (any more).
    """

    def __init__(self, objects: ObjectStorage, spool: Spool, cache: FileCache | None = None) -> None:
        self.objects = objects
        self.outbox = Outbox(objects)
        self.batches = BatchStore(objects)
        self.secret = InstallationSecret(objects)
        self.pending = PendingJobs(objects)
        self.deletions = Deletions(objects)
        self.spool = spool
        self._records = Records(objects)
        self._results = ResultFiles(objects, self._records, spool, cache)
        self._index = JobIndex(objects)
        self._computed = ComputedIndex(objects)
        self._acceptance = Acceptance(objects, self.pending, self.outbox)

    @property
    def is_local(self) -> bool:
        """Whether the jobs are files that every process of this machine can open by itself."""
        return self.objects.is_local

    @property
    def look_s(self) -> float:
        """The least pause between two looks for news of a job."""
        return self.objects.look_s

    def begin_upload(self) -> MeshUpload:
        return self.spool.begin_upload()

    def accept(self, job: Job, upload: MeshUpload) -> None:
        """Take a job in: when this returns, it will be finished, whatever happens to the queue or the power.

        Raises
        ------
        JobExists
            Where there is a job of this id already; it stays as it is.
        """
        upload.close()
        self._acceptance.accept(job, upload.path)

    def computed_before(self, job: Job) -> Job | None:
        """A job of the same owner that has succeeded with the same mesh, parameters and software."""
        job_id = self._computed.find(job)
        return self.job(job_id) if job_id and isinstance(self.outcome(job_id), Succeeded) else None

    def page(self, owner: str | None, cursor: str | None, limit: int) -> JobPage:
        """The jobs of an owner, newest first, from a cursor on."""
        return read_page(self._index, self._records, owner, cursor, limit)

    def job(self, job_id: str) -> Job | None:
        return self._records.job(job_id)

    def jobs(self, job_ids: Sequence[str]) -> dict[str, Job | None]:
        """Some jobs by their ids; None for those that are not there."""
        return dict(zip(job_ids, self._records.jobs(job_ids), strict=True))

    def outcome(self, job_id: str) -> Outcome | None:
        return self._records.outcome(job_id)

    def states(self, jobs: Sequence[Job]) -> dict[str, JobState]:
        """How some jobs are, by their ids."""
        return self._records.states([job.id for job in jobs])

    def has_ended(self, job_id: str) -> bool:
        """Whether a job has an outcome, or is no longer there: cheap enough to be asked often."""
        return self._records.has_outcome(job_id) or not self._records.has_job(job_id)

    def finish(self, job_id: str, outcome: Outcome) -> Outcome:
        """Give a job its outcome, unless it has one; the outcome that stands."""
        job = self.job(job_id)
        if job is None:
            raise UnknownJob(job_id)
        standing = self._records.finish(job_id, outcome)
        self.pending.remove(job)
        return standing

    def unfinished(self) -> dict[str, str | None]:
        """The accepted jobs without an outcome, oldest first, and their owners."""
        return self.pending.all()

    def unfinished_of(self, owner: str | None) -> list[str]:
        """Those of one owner, oldest first."""
        return self.pending.of(owner)

    def count_unfinished(self, owner: str | None) -> tuple[int, int]:
        """How many there are: of everybody, and of one owner; cheap, and now and then one too many."""
        return self.pending.count(owner)

    def oldest_s(self, at_s: float) -> float:
        """The age of the oldest of them at a time in seconds since 1970; 0 where there is none."""
        return self.pending.oldest_s(at_s)

    def begin_attempt(self, job_id: str, worker: str) -> Attempt:
        """Count one more run of a job, before it starts."""
        attempt = self._records.begin_attempt(job_id, worker)
        self.spool.remove_results(job_id)
        return attempt

    def end_attempt(self, job_id: str, attempt: Attempt, cause: Cause) -> None:
        """Note why a run ended without an outcome."""
        self._records.end_attempt(job_id, attempt, cause)

    def withdraw_attempt(self, job_id: str, attempt: Attempt) -> None:
        """Uncount a run that was stopped through no fault of the job."""
        self._records.remove_attempt(job_id, attempt)

    def attempts(self, job_id: str) -> list[Attempt]:
        """The runs of a job that count, in order."""
        return self._records.attempts(job_id)

    def open_mesh(self, job_id: str) -> BinaryIO:
        """What the client sent; a FileNotFoundError where the store has lost it."""
        job = self.job(job_id)
        try:
            return self.objects.open(job_key(job_id, MESH if job is None else mesh_name(job)))
        except FileNotFoundError:
            return self.objects.open(job_key(job_id, MESH))

    def write_result(self, job_id: str, write: Callable[[BinaryIO], object]) -> None:
        """Store the result file, whole; a second writer of the same job writes the same bytes."""
        self._results.write(job_id, write)

    def put_result(self, job_id: str, path: Path) -> None:
        """Store the result file from another file, which may be gone afterwards."""
        self._results.put(job_id, path)

    def open_result(self, job_id: str) -> BinaryIO:
        """The result file of a job that succeeded."""
        return self._results.open(job_id)

    def result_url(self, job_id: str, valid_s: float) -> str | None:
        """An address from which anybody can fetch the result file for a while; None where the store has none."""
        return self._results.presigned_url(job_id, valid_s)

    def delete(self, job_id: str) -> None:
        """Remove a job and all its files; for others it disappears at once. What stays is that it was there."""
        job = self.job(job_id)
        if job is None:
            raise UnknownJob(job_id)
        self.deletions.begin(job)
        self._remove(job)

    def finish_deletions(self, begun_s: float) -> None:
        """End the deletions that were begun longer ago than this and not ended, since the process died."""
        for job in self.deletions.begun_before(begun_s):
            self._remove(job)

    def was_deleted(self, job_id: str, owner: str | None) -> bool:
        """Whether this owner had a job of this id; it is known for some weeks."""
        return self.deletions.was_deleted(job_id, owner)

    def forget_deleted(self, deleted_s: float) -> None:
        """Forget the jobs that were deleted longer ago than this."""
        self.deletions.forget(deleted_s)

    def remove_abandoned_uploads(self, untouched_s: float) -> None:
        """Remove what uploads and runs left on this machine whose process died in the middle."""
        self.spool.remove_abandoned(untouched_s)

    def check_writable(self) -> None:
        """Raise an OSError where jobs cannot be written here."""
        self.objects.check_writable()
        with self.begin_upload() as probe:
            probe.write(b"?")
            probe.close()

    def _remove(self, job: Job) -> None:
        self.deletions.remove_objects(job)
        self._results.drop(job.id)
        self._index.remove(job)
        self._computed.remove(job)
        self.pending.remove(job)
        self.deletions.end(job)
