"""Announcements of the ends of jobs."""

import asyncio

from service.answer.endings import Endings
from worker.jobs.job import new_job_id
from worker.jobs.queue.queue import JobQueue


def test_an_announcement_wakes_those_who_wait_for_that_job(queue: JobQueue, queue_url: str) -> None:
    ended, other = new_job_id(), new_job_id()

    async def wait() -> set[str]:
        endings = Endings(queue_url)
        async with endings.listening():
            while not endings.are_announced:
                await asyncio.sleep(0.01)
            tasks = {name: asyncio.create_task(endings.pause(name, 60.0)) for name in (ended, other)}
            await asyncio.sleep(0)
            await asyncio.to_thread(queue.announce_end, ended)
            await asyncio.wait(tasks.values(), timeout=30.0, return_when=asyncio.FIRST_COMPLETED)
            woken = {name for name, task in tasks.items() if task.done()}
            tasks[other].cancel()
            return woken

    assert asyncio.run(wait()) == {ended}


def test_a_pause_ends_without_an_announcement() -> None:
    asyncio.run(Endings("unix:///nowhere/queue.sock").pause(new_job_id(), 0.01))
