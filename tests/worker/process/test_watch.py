"""A work-horse is killed for a reason, and never between the outcome of its job and its own end."""

import os
import time

import pytest

from cleave.settings import Settings
from worker.process.watch import Watch


def watched(monkeypatch: pytest.MonkeyPatch, tick_s: float, seconds: float, ends_at: float) -> tuple[str | None, float]:
    """Watch a child that runs for a time, and whose job ends at another; return why it was killed, and its time."""
    monkeypatch.setattr("worker.process.watch._TICK_S", tick_s)
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        time.sleep(seconds)
        os._exit(0)
    os.close(writer)
    began_at = time.monotonic()
    reason = Watch(Settings()).wait(child, reader, lambda: time.monotonic() - began_at > ends_at, lambda: None)
    os.waitpid(child, 0)
    return reason, time.monotonic() - began_at


def test_a_child_that_has_just_given_its_job_an_outcome_may_end_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    assert watched(monkeypatch, tick_s=3.0, seconds=3.5, ends_at=1.0)[0] is None


def test_a_child_whose_job_was_ended_by_others_is_killed_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    reason, took_s = watched(monkeypatch, tick_s=0.2, seconds=60, ends_at=0.3)
    assert reason == "ended elsewhere"
    assert took_s < 30


def test_reports_are_passed_on_and_ticks_go_on_beside_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worker.process.watch._TICK_S", 0.2)
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        for _ in range(20):
            os.write(writer, b"cut 0.5\n")
            time.sleep(0.05)
        os._exit(0)
    os.close(writer)
    reports, ticks = bytearray(), []
    Watch(Settings()).wait(child, reader, lambda: False, lambda: ticks.append(time.monotonic()), reports.extend)
    os.waitpid(child, 0)
    assert reports == 20 * b"cut 0.5\n"
    assert len(ticks) >= 2
