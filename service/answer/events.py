"""The changes of a job as server-sent events."""

import time
from collections.abc import AsyncIterator
from datetime import timedelta

from starlette.concurrency import run_in_threadpool

from service.context import Context
from service.job_documents import JobDocument
from service.lookup import describe
from worker.jobs.job import Job, now
from worker.jobs.store.store import UnknownJob

_POLL_S = 0.2  # between two reads of the state of the job; set by hand
_KEEP_ALIVE_S = 15.0  # until a comment is sent, so that proxies keep the connection, as the HTML standard advises
_RETRY_MS = 1000  # after which a client reconnects; set by hand
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
    """Yield the events of a job until its end.

    An id is the time in milliseconds since the job was accepted, so that ids increase over reconnections, also if
    another process serves them.
    """
    yield f"retry: {_RETRY_MS}\n\n"
    sent, sent_at = "", time.monotonic()
    ends_at = sent_at + context.settings.max_stream_s
    while time.monotonic() < ends_at:
        last_id = max(_milliseconds(now() - job.created_at), last_id + 1)
        try:
            document = await run_in_threadpool(describe, context, job)
        except UnknownJob:
            return
        text = document.model_dump_json()
        if text != sent:
            sent, sent_at = text, time.monotonic()
            yield f"id: {last_id}\nevent: status\ndata: {text}\n\n"
        elif time.monotonic() - sent_at > _KEEP_ALIVE_S:
            sent_at = time.monotonic()
            yield ": still here\n\n"
        if document.finished_at is not None or not await run_in_threadpool(context.store.records.job, job.id):
            return
        await context.endings.pause(job.id, max(_POLL_S, 2 * context.store.objects.poll_interval_s))


def has_last_event(document: JobDocument, last_id: int) -> bool:
    """Return whether a client that received an event with this id has received the last one."""
    return document.finished_at is not None and last_id >= _milliseconds(document.finished_at - document.created_at)


def _milliseconds(duration: timedelta) -> int:
    return int(duration / timedelta(milliseconds=1))
