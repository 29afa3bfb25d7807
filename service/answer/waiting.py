"""Waiting for the end of a job without blocking the event loop."""

import time

from starlette.concurrency import run_in_threadpool

from service.answer.endings import Endings
from worker.jobs.store.store import JobStore

# The pause between two checks is a fraction of the time waited, so that a response is late by at most a hundredth of
# the duration of a job, within limits, also if its end is not announced. Set by hand.
_PAUSE_FRACTION = 1 / 100
_SHORTEST_PAUSE_S, _LONGEST_PAUSE_S = 0.01, 0.25
_ANNOUNCED_PAUSE_S = 0.1  # if ends are announced, for those that are not: of canceled jobs; set by hand


async def wait_for_end(store: JobStore, endings: Endings, job_id: str, at_most_s: float) -> bool:
    """Wait until a job has ended or the time is over; return whether it has ended."""
    began_at = time.monotonic()
    has_ended, interval_s = store.records.has_ended, store.objects.poll_interval_s
    while not (await run_in_threadpool(has_ended, job_id) if interval_s > 0 else has_ended(job_id)):
        waited_s = time.monotonic() - began_at
        if waited_s >= at_most_s:
            return False
        shortest_s = max(_ANNOUNCED_PAUSE_S if endings.are_announced else _SHORTEST_PAUSE_S, interval_s)
        pause_s = max(min(waited_s * _PAUSE_FRACTION, _LONGEST_PAUSE_S), shortest_s)
        await endings.pause(job_id, min(pause_s, at_most_s - waited_s))
    return True
