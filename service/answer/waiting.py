"""Waiting for the end of a job without blocking the event loop."""

import asyncio
import time

from starlette.concurrency import run_in_threadpool

from worker.jobs.store.store import JobStore

# The pause between two checks is a fraction of the time waited, so that a response is late by at most a hundredth of
# the duration of a job, within limits. Set by hand.
_PAUSE_FRACTION = 1 / 100
_SHORTEST_PAUSE_S, _LONGEST_PAUSE_S = 0.01, 0.25


async def wait_for_end(store: JobStore, job_id: str, at_most_s: float) -> bool:
    """Wait until a job has ended or the time is over; return whether it has ended."""
    began_at = time.monotonic()
    has_ended, interval_s = store.records.has_ended, store.objects.poll_interval_s
    while not (await run_in_threadpool(has_ended, job_id) if interval_s > 0 else has_ended(job_id)):
        waited_s = time.monotonic() - began_at
        if waited_s >= at_most_s:
            return False
        pause_s = max(min(max(waited_s * _PAUSE_FRACTION, _SHORTEST_PAUSE_S), _LONGEST_PAUSE_S), interval_s)
        await asyncio.sleep(min(pause_s, at_most_s - waited_s))
    return True
