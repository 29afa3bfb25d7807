"""The pauses and the verdict of a soak."""

from collections import Counter
from datetime import UTC, datetime, timedelta

import pytest

from bench.commands.soak import render
from bench.soak.campaign import SoakReport, longest_pause_s
from worker.jobs.attempts import Attempt

NOON = datetime(2026, 1, 1, 12, tzinfo=UTC)


def run(number: int, began_s: float, ended_s: float | None = None) -> Attempt:
    """Return an attempt with times in seconds after noon."""
    ended_at = None if ended_s is None else NOON + timedelta(seconds=ended_s)
    return Attempt(number=number, worker="w", started_at=NOON + timedelta(seconds=began_s), ended_at=ended_at)


def test_a_pause_is_from_the_death_of_a_worker_to_the_next_attempt() -> None:
    deaths = [NOON + timedelta(seconds=seconds) for seconds in (5, 7, 50)]
    assert longest_pause_s([[run(1, 6), run(2, 20), run(3, 21)]], deaths) == 13
    assert longest_pause_s([[run(1, 6, 8), run(2, 20)]], deaths) == 0  # its worker survived and recorded the end
    assert longest_pause_s([[run(1, 60)], []], deaths) == 0


@pytest.mark.parametrize("wrong", ["lost", "failed", "duplicates", "differing"])
def test_a_report_is_clean_only_if_nothing_is_wrong(wrong: str) -> None:
    numbers = dict.fromkeys(("lost", "failed", "duplicates", "differing", "run_again", "dropped"), 0)
    times = {"resumed_s": 12.34, "settled_s": 5.0}
    clean = SoakReport(jobs=9, kills=Counter({"worker": 2, "janitor": 1}), **numbers, **times)
    assert clean.is_clean
    assert not SoakReport(jobs=9, kills=Counter(), **{**numbers, wrong: 1}, **times).is_clean
    text = render(clean)
    assert "| kills (1 janitor, 2 worker) | 3 |" in text
    assert "| longest time from the death of a worker until its job ran again, s | 12.3 |" in text
