"""The stored command: its folders are those of the service, and its table compares both numbers of jobs."""

from pathlib import Path

import pytest

from bench.__main__ import main
from bench.commands.stored import render
from bench.stored.cost import Cost, cost_of
from bench.stored.filling import OWNERS, fill, fill_waiting
from worker.jobs.job import Succeeded
from worker.jobs.store.opening import open_folder
from worker.jobs.store.store import JobStore


def listed(store: JobStore) -> list[str]:
    return [job.id for owner in OWNERS for job in store.page(owner, None, 1000).jobs]


def test_a_filled_folder_is_a_store_of_ended_jobs(tmp_path: Path) -> None:
    filled = fill(tmp_path, 210, expired=40)
    store = open_folder(tmp_path)
    jobs = listed(store)
    assert len(set(jobs)) == 210
    assert sorted(jobs) == sorted(entry.id for entry in store.ended.oldest("", 1000))
    for entry in store.ended.oldest("", 1000):
        job, outcome = store.records.job(entry.id), store.records.outcome(entry.id)
        assert store.ended.key_of(job, outcome) == entry.key
        assert isinstance(outcome, Succeeded) == (entry.id in store.computed.equal_to(job))
        assert len(store.records.attempts(entry.id)) == 1
    assert [job.created_at for job in filled.samples] == sorted(
        (job.created_at for job in filled.samples), reverse=True
    )
    store.delete(jobs[0])
    assert len(listed(store)) == len(store.ended.oldest("", 1000)) == 209


def test_waiting_jobs_are_unfinished(tmp_path: Path) -> None:
    fill_waiting(tmp_path, 5)
    store = open_folder(tmp_path)
    assert len(store.pending.unfinished(store.pending.markers())) == len(listed(store)) == 5


def test_costs_are_compared() -> None:
    few, many = Cost(0.002, 0.001, 2_000_000), Cost(0.003, 0.001, 0)
    row = render({"a job": few}, {"a job": many}, "1 job", "9 jobs").splitlines()[2].split()
    assert row == ["a", "job", "2.00", "1.00", "2.0", "3.00", "1.00", "0.0", "1.50", "1.00"]


def test_every_run_has_a_number_and_those_that_warm_up_do_not_count() -> None:
    runs: list[int] = []
    assert cost_of(runs.append, 5).wall_s >= 0
    assert runs == list(range(8))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--jobs", "999"], "--jobs must be at least 1000"),
        (["--data", "nowhere"], "nowhere is not a folder"),
        (["--jobs", "1000000000000"], "has no room"),
    ],
)
def test_arguments_are_checked(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["stored", *arguments]) == 2
    assert message in capsys.readouterr().err
