"""Waiting for the end of a job without holding up anybody else."""

import asyncio
import time

from starlette.concurrency import run_in_threadpool

from worker.jobs.store.store import JobStore

_SHORTEST_PAUSE_S, _LONGEST_PAUSE_S = 0.01, 0.25
_PAUSES = 100.0  # looks per doubling of the time waited: an answer is late by a hundredth of what the job takes


async def wait_for_end(store: JobStore, job_id: str, at_most_s: float) -> bool:
    """Return when a job has ended or the time is over; whether it has ended."""
    began_at = time.monotonic()
    has_ended, interval_s = store.records.has_ended, store.objects.poll_interval_s
    while not (await run_in_threadpool(has_ended, job_id) if interval_s > 0 else has_ended(job_id)):
        waited_s = time.monotonic() - began_at
        if waited_s >= at_most_s:
            return False
        pause_s = max(min(max(waited_s / _PAUSES, _SHORTEST_PAUSE_S), _LONGEST_PAUSE_S), interval_s)
        await asyncio.sleep(min(pause_s, at_most_s - waited_s))
    return True
