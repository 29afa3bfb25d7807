"""The records of a job in the store: the job itself, its attempts, its outcome."""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from pydantic import TypeAdapter

from worker.jobs.attempts import Attempt, Cause
from worker.jobs.job import Job, Outcome, is_job_id, now
from worker.jobs.objects.interface import ObjectStorage, name_of
from worker.jobs.store.layout import MANIFEST, RECORD, REVISIONS, job_folder, job_key, revision_number

JOB = TypeAdapter(Job)
ATTEMPT = TypeAdapter(Attempt)
OUTCOME: TypeAdapter[Outcome] = TypeAdapter(Outcome)
_CACHED_JOBS = 10_000  # about 15 MB: a state with one attempt takes 1.5 kB

Document = TypeVar("Document")


class UnknownJob(LookupError):  # noqa: N818
    """There is no such job in the store, or no longer."""


@dataclass(frozen=True, slots=True)
class JobState:
    """The outcome and the attempts of a job."""

    outcome: Outcome | None
    attempts: list[Attempt]  # those that count, in order
    revision: int = 0  # the newest; 0 if there is none. Of a remote storage, at the time when the state was first read


class Records:
    """Reads and writes the records of jobs.

    Every write raises UnknownJob if the job has been deleted, also if that happens during the write. Outcomes never
    change, so those of a remote storage are cached.
    """

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects
        self._outcomes: OrderedDict[str, Outcome] = OrderedDict()
        self._ended: OrderedDict[str, JobState] = OrderedDict()

    def job(self, job_id: str) -> Job | None:
        return self._read(job_key(job_id, RECORD), JOB) if is_job_id(job_id) else None

    def jobs(self, job_ids: Sequence[str]) -> dict[str, Job | None]:
        """Return some jobs by their ids; None for those that do not exist."""
        return dict(zip(job_ids, self._objects.each(self.job, job_ids), strict=True))

    def has_job(self, job_id: str) -> bool:
        return self._objects.exists(job_key(job_id, RECORD))

    def require(self, job_id: str, undo: Callable[[], None] = lambda: None) -> None:
        """Raise UnknownJob if a job does not exist, after undoing what was written for it."""
        if not self.has_job(job_id):
            undo()
            raise UnknownJob(job_id)

    def create_job(self, job: Job) -> bool:
        """Return True if this is now the job of this id, False if there is another one; it is not durable yet."""
        return self._objects.create(job_key(job.id, RECORD), JOB.dump_json(job), durable=False)

    def outcome(self, job_id: str) -> Outcome | None:
        key = job_key(job_id, MANIFEST)
        outcome = self._outcomes.get(job_id) or self._read(key, OUTCOME)
        if outcome is not None:
            self._add_to(self._outcomes, job_id, outcome)
        return outcome

    def has_outcome(self, job_id: str) -> bool:
        return job_id in self._outcomes or self._objects.exists(job_key(job_id, MANIFEST))

    def has_ended(self, job_id: str) -> bool:
        """Whether a job has an outcome or no longer exists; cheap enough to be called often."""
        return self.has_outcome(job_id) or not self.has_job(job_id)

    def write_outcome(self, job_id: str, outcome: Outcome) -> Outcome:
        """Write the outcome of a job unless there is one; return the one that is stored, and may not be durable yet."""
        self._objects.create(job_key(job_id, MANIFEST), OUTCOME.dump_json(outcome), durable=False)
        standing = self.outcome(job_id)
        self.require(job_id, lambda: self._remove_outcome(job_id))
        return standing or outcome

    def attempts(self, job_id: str) -> list[Attempt]:
        """Return the runs of a job that count, in order."""
        return self._attempts_in(self._objects.keys_below(job_folder(job_id)))

    def add_attempt(self, job_id: str, worker: str) -> Attempt:
        """Count one more run. A crash of the machine may undo this, which does not show that the job is at fault."""
        self.require(job_id)
        attempt = Attempt(number=len(self.attempts(job_id)) + 1, worker=worker, started_at=now())
        while not self._objects.create(_attempt_key(job_id, attempt), ATTEMPT.dump_json(attempt), durable=False):
            attempt = replace(attempt, number=attempt.number + 1)
        self.require(job_id, lambda: self.withdraw_attempt(job_id, attempt))
        return attempt

    def end_attempt(self, job_id: str, attempt: Attempt, cause: Cause) -> None:
        """Record why a run ended without an outcome."""
        self.require(job_id)
        ended = replace(attempt, ended_at=now(), cause=cause)
        self._objects.put(_attempt_key(job_id, attempt), ATTEMPT.dump_json(ended))
        self.require(job_id, lambda: self.withdraw_attempt(job_id, attempt))

    def withdraw_attempt(self, job_id: str, attempt: Attempt) -> None:
        """Do not count a run that was stopped for a reason that is not the job's fault."""
        self._objects.delete(_attempt_key(job_id, attempt))

    def states(self, job_ids: Sequence[str]) -> dict[str, JobState]:
        """Return the states of some jobs by their ids."""
        return dict(zip(job_ids, self._objects.each(self._state, job_ids), strict=True))

    def _state(self, job_id: str) -> JobState:
        cached = self._ended.get(job_id)
        if cached is not None:
            return cached
        keys = self._objects.keys_below(job_folder(job_id))
        state = JobState(self.outcome(job_id), self._attempts_in(keys), _newest_revision_in(keys))
        if state.outcome is not None:
            self._add_to(self._ended, job_id, state)
        return state

    def forget_state(self, job_id: str) -> None:
        """Read the state of a job again, as this process has changed it."""
        self._ended.pop(job_id, None)

    def _attempts_in(self, keys: list[str]) -> list[Attempt]:
        found = (self._read(key, ATTEMPT) for key in keys if name_of(key).startswith("attempt-"))
        return sorted((attempt for attempt in found if attempt), key=lambda attempt: attempt.number)

    def _add_to(self, cache: OrderedDict[str, Document], job_id: str, document: Document) -> None:
        if self._objects.poll_interval_s > 0:
            cache[job_id] = document
            if len(cache) > _CACHED_JOBS:
                cache.popitem(last=False)

    def _remove_outcome(self, job_id: str) -> None:
        self._objects.delete(job_key(job_id, MANIFEST))
        self._outcomes.pop(job_id, None)
        self._ended.pop(job_id, None)

    def _read(self, key: str, adapter: TypeAdapter[Document]) -> Document | None:
        text = self._objects.get(key)
        return None if text is None else adapter.validate_json(text)


def _attempt_key(job_id: str, attempt: Attempt) -> str:
    return job_key(job_id, f"attempt-{attempt.number}.json")


def _newest_revision_in(keys: list[str]) -> int:
    return max((revision_number(key) for key in keys if f"/{REVISIONS}/" in key), default=0)
