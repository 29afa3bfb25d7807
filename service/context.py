"""What the routes work with: the store, the queue and the opened results of one application."""

import time
from dataclasses import dataclass, field
from typing import Annotated

from fastapi import Depends, Request

from cleave.settings import Settings
from service.keys import KeyRing
from service.result_cache import ResultCache
from service.telemetry.metrics import Metrics
from worker.jobs.admission import admit
from worker.jobs.job import Canceled, Job, Outcome, now
from worker.jobs.objects.durable import is_disk_full
from worker.jobs.queue.connection import QueueError
from worker.jobs.queue.counters import JobCounters
from worker.jobs.queue.queue import Activity, JobQueue
from worker.jobs.queue.quota import UploadQuota
from worker.jobs.store.batches import BatchStore
from worker.jobs.store.installation_secret import InstallationSecret
from worker.jobs.store.store import JobStore

_PAUSE_S = 1.0


@dataclass(slots=True)
class QueueView:
    """The queue for readers who can do without: one that does not answer is left alone for a moment.

    So a hung queue server holds up one reader a second, not all of them.
    """

    queue: JobQueue
    _asleep_until: float = field(default=0.0, init=False)

    def activities(self, job_ids: list[str]) -> dict[str, Activity]:
        """What the queue knows about some jobs; nothing where it does not answer."""
        if not job_ids or time.monotonic() < self._asleep_until:
            return {}
        try:
            return self.queue.activities(job_ids)
        except QueueError:
            self._asleep_until = time.monotonic() + _PAUSE_S
            return {}


@dataclass(frozen=True, slots=True)
class Context:
    settings: Settings
    version: str  # of the software
    store: JobStore
    queue: JobQueue
    view: QueueView
    quota: UploadQuota
    results: ResultCache
    secret: InstallationSecret
    keys: KeyRing
    keys_required: bool
    metrics: Metrics
    batches: BatchStore

    def admit(self, owner: str | None, new: Job | None = None) -> None:
        admit(self.store, self.queue, self.settings, owner, new)

    def cancel(self, job: Job) -> Outcome:
        """End a job that has not ended; the outcome that stands."""
        canceled = Canceled(finished_at=now())
        outcome = self.store.finish(job.id, canceled)
        if isinstance(outcome, Canceled) and self.withdraw(job) and outcome.finished_at == canceled.finished_at:
            JobCounters(self.queue.connection).job_canceled()
        return outcome

    def discard(self, job: Job) -> None:
        """Remove a job with its files; one that has not finished is canceled first."""
        try:
            self.cancel(job)
        except OSError as error:
            if not is_disk_full(error):  # what makes room must be possible then
                raise
        self.store.delete(job.id)
        self.results.drop(job.id)
        self.withdraw(job)

    def withdraw(self, job: Job) -> bool:
        """Take a job that is no longer wanted out of the queue; where that fails, the worker drops it that takes it."""
        try:
            self.queue.forget(job.id)
            self.admit(job.owner)
        except QueueError:
            return False
        return True


async def _context(request: Request) -> Context:
    context: Context = request.app.state.context
    return context


ContextOf = Annotated[Context, Depends(_context)]
