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
    while not (store.has_ended(job_id) if store.is_local else await run_in_threadpool(store.has_ended, job_id)):
        waited_s = time.monotonic() - began_at
        if waited_s >= at_most_s:
            return False
        pause_s = max(min(max(waited_s / _PAUSES, _SHORTEST_PAUSE_S), _LONGEST_PAUSE_S), store.look_s)
        await asyncio.sleep(min(pause_s, at_most_s - waited_s))
    return True
