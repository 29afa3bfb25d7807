"""Waiting for the end of a job: short delays without a busy loop."""

import asyncio
from typing import cast

import pytest

from service.answer import waiting
from service.answer.endings import Endings
from worker.jobs.store.store import JobStore


class Clock:
    """A clock that advances only in pauses, and a store with a job that ends at a given time."""

    poll_interval_s = 0.0
    are_announced = False

    def __init__(self, ends_at: float) -> None:
        self.now, self.polls = 0.0, 0
        self._ends_at = ends_at
        self.records = self.objects = self

    def monotonic(self) -> float:
        return self.now

    async def pause(self, _: str, pause_s: float) -> None:
        self.now += pause_s

    def has_ended(self, _: str) -> bool:
        self.polls += 1
        return self.now >= self._ends_at


def wait(monkeypatch: pytest.MonkeyPatch, clock: Clock, at_most_s: float) -> bool:
    monkeypatch.setattr(waiting, "time", clock)
    return asyncio.run(waiting.wait_for_end(cast(JobStore, clock), cast(Endings, clock), "job", at_most_s))


@pytest.mark.parametrize("takes_s", [0.004, 0.3, 0.7, 5.0, 20.0])
def test_the_delay_is_at_most_a_hundredth_of_the_duration_of_the_job(
    monkeypatch: pytest.MonkeyPatch, takes_s: float
) -> None:
    clock = Clock(takes_s)
    assert wait(monkeypatch, clock, 60.0)
    assert clock.now - takes_s <= max(0.0101, 0.0101 * takes_s)


def test_a_timeout_is_exact_and_the_polling_is_not_a_busy_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = Clock(float("inf"))
    assert not wait(monkeypatch, clock, 60.0)
    assert clock.now == pytest.approx(60.0)
    assert clock.polls < 1000
