"""The state of one application that its routes share: settings, store, queue, caches and metrics."""

import time
from dataclasses import dataclass, field
from typing import Annotated

from fastapi import Depends, Request

from cleave.settings import Settings
from service.answer.endings import Endings
from service.edit.editors import Editors
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

_RETRY_AFTER_S = 1.0  # set by hand


@dataclass(slots=True)
class QueueView:
    """Read access to the queue for callers that can do without it.

    If Redis does not answer, return no activity and retry after one second. A Redis server that hangs then delays one
    reader per second instead of all of them.
    """

    queue: JobQueue
    _retry_at: float = field(default=0.0, init=False)  # on the monotonic clock

    def activities(self, job_ids: list[str]) -> dict[str, Activity]:
        """Return the activity of each job in the queue, by job id; empty if Redis does not answer."""
        if not job_ids or time.monotonic() < self._retry_at:
            return {}
        try:
            return self.queue.activities(job_ids)
        except QueueError:
            self._retry_at = time.monotonic() + _RETRY_AFTER_S
            return {}


@dataclass(frozen=True, slots=True)
class Context:
    """The shared state of one application."""

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
    editors: Editors
    endings: Endings

    def admit(self, owner: str | None, new: Job | None = None) -> None:
        """Move waiting jobs of an owner into the queue, as many as the owner may have there."""
        admit(self.store, self.queue, self.settings, owner, new)

    def cancel(self, job: Job) -> Outcome:
        """End a job unless it has ended, and return its outcome."""
        canceled = Canceled(finished_at=now())
        outcome = self.store.finish(job.id, canceled)
        if isinstance(outcome, Canceled) and self.withdraw(job) and outcome.finished_at == canceled.finished_at:
            JobCounters(self.queue.connection).job_canceled()
        return outcome

    def discard(self, job: Job) -> None:
        """Delete a job and its files; an unfinished job is canceled first."""
        try:
            self.cancel(job)
        except OSError as error:
            if not is_disk_full(error):  # deleting must be possible on a full disk
                raise
        self.store.delete(job.id)
        self.results.drop(job.id)
        self.withdraw(job)

    def withdraw(self, job: Job) -> bool:
        """Remove a job from the queue. Return False if that fails; the worker that dequeues the job then drops it."""
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
