"""What the routes work with: the store, the queue and the opened results of one application."""

import time
from dataclasses import dataclass, field
from typing import Annotated

from fastapi import Depends, Request

from service.results import ResultCache
from worker.queue import Activity, JobQueue, QueueError
from worker.settings import Settings
from worker.store import LocalStore

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
    store: LocalStore
    queue: JobQueue
    view: QueueView
    results: ResultCache


async def _context(request: Request) -> Context:
    context: Context = request.app.state.context
    return context


ContextOf = Annotated[Context, Depends(_context)]
