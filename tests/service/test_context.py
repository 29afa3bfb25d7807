"""The view of the queue tolerates a failing Redis."""

from typing import cast

import pytest

from service import context
from service.context import QueueView
from worker.jobs.queue.connection import QueueError
from worker.jobs.queue.queue import Activity, JobQueue


class FailingQueue:
    """A queue that does not answer; it counts the requests, and advances a clock by hand."""

    def __init__(self) -> None:
        self.now, self.requests = 100.0, 0

    def monotonic(self) -> float:
        return self.now

    def activities(self, _: list[str]) -> dict[str, Activity]:
        self.requests += 1
        raise QueueError


def test_a_queue_that_does_not_answer_is_asked_once_per_second(monkeypatch: pytest.MonkeyPatch) -> None:
    queue = FailingQueue()
    monkeypatch.setattr(context, "time", queue)
    view = QueueView(cast(JobQueue, queue))
    for now, requests in ((100.0, 1), (100.9, 1), (101.1, 2), (102.0, 2)):
        queue.now = now
        assert view.activities(["0" * 32]) == {}
        assert queue.requests == requests
