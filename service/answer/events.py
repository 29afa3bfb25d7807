"""Server-sent events: how a job is, told whenever it changes."""

import asyncio
import time
from collections.abc import AsyncIterator
from datetime import timedelta

from starlette.concurrency import run_in_threadpool

from service.context import Context
from service.documents import JobDocument
from service.lookup import describe
from worker.jobs.job import Job, now
from worker.jobs.store.store import UnknownJob

_LOOK_S = 0.2  # between two looks at the job
_SILENCE_S = 15.0  # after so long a comment keeps proxies from closing the connection
_RETRY_MS = 1000  # when a client that lost the connection comes back
EVENT_SCHEMA = {
    "type": "object",
    "required": ["id", "event", "data"],
    "properties": {
        "id": {"type": "string", "pattern": "^[0-9]+$"},
        "event": {"const": "status"},
        "data": {
            "type": "string",
            "contentMediaType": "application/json",
            "contentSchema": {"$ref": "#/components/schemas/JobDocument"},
        },
    },
}


async def job_events(context: Context, job: Job, last_id: int) -> AsyncIterator[str]:
    """The events of a job from now on; the last one is that of its end.

    An id is the time since the job was accepted, in milliseconds, so it grows over reconnections, whoever answers them.
    """
    yield f"retry: {_RETRY_MS}\n\n"
    said, said_at = "", time.monotonic()
    ends_at = said_at + context.settings.max_stream_s
    while time.monotonic() < ends_at:
        last_id = max(_milliseconds(now() - job.created_at), last_id + 1)
        try:
            document = await run_in_threadpool(describe, context, job)
        except UnknownJob:
            return
        text = document.model_dump_json()
        if text != said:
            said, said_at = text, time.monotonic()
            yield f"id: {last_id}\nevent: status\ndata: {text}\n\n"
        elif time.monotonic() - said_at > _SILENCE_S:
            said_at = time.monotonic()
            yield ": still here\n\n"
        if document.finished_at is not None or not await run_in_threadpool(context.store.records.job, job.id):
            return
        await asyncio.sleep(max(_LOOK_S, 2 * context.store.objects.poll_interval_s))


def has_seen_the_end(document: JobDocument, last_id: int) -> bool:
    """Whether a client that got this id got the last event, so that coming back would be for nothing."""
    return document.finished_at is not None and last_id >= _milliseconds(document.finished_at - document.created_at)


def _milliseconds(duration: timedelta) -> int:
    return int(duration / timedelta(milliseconds=1))
