"""The processes of an installation, and the number of workers of each queue."""

import pytest

from cleave.settings import Settings
from helpers.jobs import LARGE, SMALL
from service.host.programs import worker_counts, worker_programs
from worker.jobs.size_class import SizeClass


@pytest.mark.parametrize(("workers", "small", "large"), [(1, 1, 1), (2, 1, 1), (4, 3, 1), (8, 6, 2)])
def test_small_and_large_jobs_have_their_own_workers(workers: int, small: int, large: int) -> None:
    assert worker_counts(workers) == {SMALL: small, LARGE: large}


def test_one_queue_can_have_all_workers_and_a_service_none() -> None:
    assert worker_counts(3, LARGE) == {LARGE: 3}
    assert worker_counts(0) == {}
    assert set(worker_counts(None)) == set(SizeClass)


def test_every_worker_process_serves_one_queue() -> None:
    settings = Settings(redis_url="unix:///nowhere.sock")
    programs = worker_programs(settings, {SMALL: 2, LARGE: 1})
    last_words = [program.command[-1] for program in programs if "worker.process" in program.command]
    assert last_words == ["small", "small", "large"]
    assert len({program.name for program in programs}) == len(programs)
