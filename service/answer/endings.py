"""Announcements of the ends of jobs in Redis, which wake those who wait for one before their next look at the store."""

import asyncio
from collections import defaultdict
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

from redis.asyncio import Redis

from worker.jobs.queue.connection import QueueError, text_of
from worker.jobs.queue.queue import ENDINGS_CHANNEL

_RETRY_S = 1.0  # after Redis has closed the connection; set by hand


class Endings:
    """Listens to the announcements of workers. None is needed: whoever waits looks at the store now and then."""

    def __init__(self, redis_url: str) -> None:
        self._redis_url = redis_url
        self._waiting: defaultdict[str, set[asyncio.Event]] = defaultdict(set)
        self.are_announced = False  # whether this process listens

    @asynccontextmanager
    async def listening(self) -> AsyncIterator[None]:
        """Listen until the context exits."""
        task = asyncio.create_task(self._listen())
        try:
            yield
        finally:
            task.cancel()
            with suppress(asyncio.CancelledError):
                await task

    async def pause(self, job_id: str, seconds: float) -> None:
        """Sleep until the end of a job is announced, at most for a time."""
        event = asyncio.Event()
        self._waiting[job_id].add(event)
        try:
            with suppress(TimeoutError):
                await asyncio.wait_for(event.wait(), seconds)
        finally:
            self._waiting[job_id].discard(event)
            if not self._waiting[job_id]:
                del self._waiting[job_id]

    async def _listen(self) -> None:
        while True:
            with suppress(QueueError, OSError):
                await self._listen_once()
            await asyncio.sleep(_RETRY_S)

    async def _listen_once(self) -> None:
        async with Redis.from_url(self._redis_url) as connection, connection.pubsub() as channel:
            await channel.subscribe(ENDINGS_CHANNEL)
            try:
                async for message in channel.listen():
                    self.are_announced = True  # the first message confirms the subscription
                    if message["type"] == "message":
                        self._wake(text_of(message["data"]))
            finally:
                self.are_announced = False

    def _wake(self, job_id: str) -> None:
        for event in self._waiting.get(job_id, ()):
            event.set()
