"""Where jobs live: one folder for each, the truth about every one of them.

    <data>/incoming/<random>/      a mesh that is being uploaded
    <data>/pending/<id>[.<owner>]  empty: the job has no outcome yet (an index of jobs/, made before and removed after)
    <data>/index/<owner>/          which jobs there are, by time
    <data>/computed/<owner>/       which job has computed what
    <data>/outbox/<id>             its webhook is still to be told
    <data>/gone/<id>               the job was deleted; in it, whose it was
    <data>/jobs/<id>/job.json      the job is accepted
                    /mesh          the bytes that the client sent
                    /attempt-<n>.json
                    /result.cleave mesh and hierarchy
                    /manifest.json the outcome, written last and once: the job is finished

The folder of a job appears by a rename when all of it is durable, so a job is accepted whole or not at all.
"""

import errno
import os
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO, TypeVar

from pydantic import TypeAdapter

from worker.computed import ComputedIndex
from worker.durable import TEMPORARY_SUFFIX, create_file, replace_file, sync_folder
from worker.index import JobIndex, entry_name, is_entry_name, job_id_of
from worker.jobs import Attempt, Cause, Job, Outcome, Succeeded, is_job_id, new_job_id, now
from worker.outbox import Letter, Outbox
from worker.pending import PendingJobs
from worker.upload import MeshUpload

_JOB = TypeAdapter(Job)
_ATTEMPT = TypeAdapter(Attempt)
_OUTCOME: TypeAdapter[Outcome] = TypeAdapter(Outcome)

Document = TypeVar("Document")


class UnknownJob(LookupError):  # noqa: N818
    """The store has no such job (any more)."""


class JobExists(Exception):  # noqa: N818
    """There is a job of this id already."""


@dataclass(frozen=True, slots=True)
class JobPage:
    """Some jobs of an owner, newest first."""

    jobs: list[Job]
    next_cursor: str | None  # of the jobs that are older; None: there are none


class JobStore:
    """The jobs of a folder; processes and machines that share the folder share the jobs."""

    def __init__(self, data_dir: Path) -> None:
        self._jobs = data_dir / "jobs"
        self._incoming = data_dir / "incoming"
        self._gone = data_dir / "gone"
        self._index = JobIndex(data_dir / "index")
        self._computed = ComputedIndex(data_dir / "computed")
        self._outbox = Outbox(data_dir)
        self._pending = PendingJobs(data_dir / "pending", self._jobs)
        for folder in (self._jobs, self._incoming, self._gone):
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)

    def begin_upload(self) -> MeshUpload:
        return MeshUpload(self._incoming / new_job_id())

    def accept(self, job: Job, upload: MeshUpload) -> None:
        """Take a job in: when this returns, it will be finished, whatever happens to the queue or the power.

        Raises
        ------
        JobExists
            Where there is a job of this id already; it stays as it is.
        """
        if self._folder(job.id).exists():
            raise JobExists(job.id)
        upload.make_durable()
        create_file(upload.folder / "job.json", _JOB.dump_json(job))
        self._index.add(job)
        if job.webhook_url is not None:
            self._outbox.put(job.id, Letter())
        self._pending.add(job)
        try:
            os.rename(upload.folder, self._folder(job.id))
        except OSError as error:
            self._index.remove(job)
            if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
                raise
            raise JobExists(job.id) from error
        sync_folder(self._jobs)
        self._computed.note(job)

    def computed_before(self, job: Job) -> Job | None:
        """A job of the same owner that has succeeded with the same mesh, parameters and software."""
        job_id = self._computed.find(job)
        return self.job(job_id) if job_id and isinstance(self.outcome(job_id), Succeeded) else None

    def page(self, owner: str | None, cursor: str | None, limit: int) -> JobPage:
        """The jobs of an owner, newest first, from a cursor on."""
        entries = self._index.page(owner, cursor, limit + 1)
        found = ((entry, self.job(job_id_of(entry))) for entry in entries[:limit] if is_entry_name(entry))
        jobs = [job for entry, job in found if job is not None and entry_name(job) == entry]
        return JobPage(jobs, entries[limit - 1] if len(entries) > limit else None)

    def job(self, job_id: str) -> Job | None:
        return _read(self._folder(job_id) / "job.json", _JOB) if is_job_id(job_id) else None

    def outcome(self, job_id: str) -> Outcome | None:
        return _read(self._folder(job_id) / "manifest.json", _OUTCOME)

    def has_ended(self, job_id: str) -> bool:
        """Whether a job has an outcome, or is no longer there: cheap enough to be asked often."""
        folder = self._folder(job_id)
        return (folder / "manifest.json").exists() or not (folder / "job.json").exists()

    def finish(self, job_id: str, outcome: Outcome) -> Outcome:
        """Give a job its outcome, unless it has one; the outcome that stands.

        Raises
        ------
        UnknownJob
            Where the job was deleted.
        """
        folder = self._folder(job_id)
        try:
            create_file(folder / "manifest.json", _OUTCOME.dump_json(outcome))
        except FileNotFoundError as error:
            raise UnknownJob(job_id) from error
        job = self.job(job_id)
        if job is not None:
            self._pending.remove(job)
        return self.outcome(job_id) or outcome

    def unfinished(self) -> dict[str, str | None]:
        """The accepted jobs without an outcome, oldest first, and their owners."""
        return self._pending.all()

    def unfinished_of(self, owner: str | None) -> list[str]:
        """Those of one owner, oldest first."""
        return self._pending.of(owner)

    def count_unfinished(self, owner: str | None) -> tuple[int, int]:
        """How many there are: of everybody, and of one owner; cheap, and now and then one too many."""
        return self._pending.count(owner)

    def oldest_s(self, at_s: float) -> float:
        """The age of the oldest of them at a time in seconds since 1970; 0 where there is none."""
        return self._pending.oldest_s(at_s)

    def begin_attempt(self, job_id: str, worker: str) -> Attempt:
        """Count one more run of a job, before it starts.

        Raises
        ------
        UnknownJob
            Where the job was deleted.
        """
        folder = self._folder(job_id)
        attempt = Attempt(number=len(self.attempts(job_id)) + 1, worker=worker, started_at=now())
        try:
            while not create_file(_attempt_file(folder, attempt), _ATTEMPT.dump_json(attempt)):
                attempt = replace(attempt, number=attempt.number + 1)
        except FileNotFoundError as error:
            raise UnknownJob(job_id) from error
        _remove_torn_files(folder)
        return attempt

    def end_attempt(self, job_id: str, attempt: Attempt, cause: Cause) -> None:
        """Note why a run ended without an outcome.

        Raises
        ------
        UnknownJob
            Where the job was deleted.
        """
        ended = _ATTEMPT.dump_json(replace(attempt, ended_at=now(), cause=cause))
        try:
            replace_file(_attempt_file(self._folder(job_id), attempt), lambda target: target.write(ended))
        except FileNotFoundError as error:
            raise UnknownJob(job_id) from error

    def withdraw_attempt(self, job_id: str, attempt: Attempt) -> None:
        """Uncount a run that was stopped through no fault of the job."""
        _attempt_file(self._folder(job_id), attempt).unlink(missing_ok=True)

    def attempts(self, job_id: str) -> list[Attempt]:
        """The runs of a job that count, in order."""
        files = self._folder(job_id).glob("attempt-*.json")
        read = (_read(file, _ATTEMPT) for file in files)
        return sorted((attempt for attempt in read if attempt), key=lambda attempt: attempt.number)

    def open_mesh(self, job_id: str) -> BinaryIO:
        return (self._folder(job_id) / "mesh").open("rb")

    def write_result(self, job_id: str, write: Callable[[BinaryIO], object]) -> None:
        """Store the result file, whole; a second writer of the same job writes the same bytes."""
        replace_file(self._folder(job_id) / "result.cleave", write)

    def open_result(self, job_id: str) -> BinaryIO:
        """The result file of a job that succeeded.

        Raises
        ------
        UnknownJob
            Where the job was deleted.
        """
        try:
            return (self._folder(job_id) / "result.cleave").open("rb")
        except FileNotFoundError as error:
            raise UnknownJob(job_id) from error

    def delete(self, job_id: str) -> None:
        """Remove a job and all its files; for others it disappears at once. What stays is that it was there.

        Raises
        ------
        UnknownJob
            Where there is none.
        """
        job, doomed = self.job(job_id), self._incoming / new_job_id()
        if job is None:
            raise UnknownJob(job_id)
        replace_file(self._gone / job_id, lambda target: target.write((job.owner or "").encode()))
        try:
            os.rename(self._folder(job_id), doomed)
        except FileNotFoundError as error:
            raise UnknownJob(job_id) from error
        self._index.remove(job)
        self._computed.remove(job)
        self._pending.remove(job)
        shutil.rmtree(doomed, ignore_errors=True)

    def was_deleted(self, job_id: str, owner: str | None) -> bool:
        """Whether this owner had a job of this id; it is known for some weeks."""
        try:
            return is_job_id(job_id) and (self._gone / job_id).read_text() == (owner or "")
        except FileNotFoundError:
            return False

    def forget_deleted(self, deleted_s: float) -> None:
        """Forget the jobs that were deleted longer ago than this."""
        oldest = time.time() - deleted_s
        for trace in os.scandir(self._gone):
            if _modified_at(Path(trace)) < oldest:
                Path(trace).unlink(missing_ok=True)

    def remove_abandoned_uploads(self, untouched_s: float) -> None:
        """Remove what uploads left behind whose process died in the middle."""
        oldest = time.time() - untouched_s
        for folder in self._incoming.iterdir():
            if max((_modified_at(path) for path in (folder, *folder.glob("*"))), default=0.0) < oldest:
                shutil.rmtree(folder, ignore_errors=True)

    def check_writable(self) -> None:
        """Raise an OSError where jobs cannot be written here."""
        with self.begin_upload() as probe:
            create_file(probe.folder / "probe", b"?")

    def _folder(self, job_id: str) -> Path:
        if not is_job_id(job_id):
            raise ValueError(f"Not the id of a job: {job_id!r}.")
        return self._jobs / job_id


def _attempt_file(folder: Path, attempt: Attempt) -> Path:
    return folder / f"attempt-{attempt.number}.json"


def _read(path: Path, adapter: TypeAdapter[Document]) -> Document | None:
    try:
        return adapter.validate_json(path.read_bytes())
    except (FileNotFoundError, NotADirectoryError):
        return None


def _remove_torn_files(folder: Path) -> None:
    for torn in folder.glob(f".*{TEMPORARY_SUFFIX}"):
        torn.unlink(missing_ok=True)


def _modified_at(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except FileNotFoundError:
        return 0.0
