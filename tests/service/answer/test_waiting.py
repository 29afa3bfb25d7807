"""Waiting for the end of a job: the answer follows soon, and a long wait is no busy loop."""

import asyncio
from typing import cast

import pytest

from service.answer import waiting
from worker.jobs.store.store import JobStore


class Clock:
    """Time that passes only while somebody sleeps, and a store in which a job ends at some time."""

    poll_interval_s = 0.0

    def __init__(self, ends_at: float) -> None:
        self.now, self.looks = 0.0, 0
        self._ends_at = ends_at
        self.records = self.objects = self

    def monotonic(self) -> float:
        return self.now

    async def sleep(self, pause_s: float) -> None:
        self.now += pause_s

    def has_ended(self, _: str) -> bool:
        self.looks += 1
        return self.now >= self._ends_at


def wait(monkeypatch: pytest.MonkeyPatch, clock: Clock, at_most_s: float) -> bool:
    monkeypatch.setattr(waiting, "time", clock)
    monkeypatch.setattr(waiting, "asyncio", clock)
    return asyncio.run(waiting.wait_for_end(cast(JobStore, clock), "job", at_most_s))


@pytest.mark.parametrize("takes_s", [0.004, 0.3, 0.7, 5.0, 20.0])
def test_the_answer_is_late_by_a_hundredth_of_what_the_job_takes(
    monkeypatch: pytest.MonkeyPatch, takes_s: float
) -> None:
    clock = Clock(takes_s)
    assert wait(monkeypatch, clock, 60.0)
    assert clock.now - takes_s <= max(0.0101, 0.0101 * takes_s)


def test_who_waits_in_vain_waits_as_long_as_was_said_and_looks_now_and_then(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = Clock(float("inf"))
    assert not wait(monkeypatch, clock, 60.0)
    assert clock.now == pytest.approx(60.0)
    assert clock.looks < 1000
