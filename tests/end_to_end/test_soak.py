"""A short soak test: results are the same although processes are killed at random."""

from bench.soak.campaign import SoakPlan, soak


def test_random_kills_lose_no_job_and_change_no_result() -> None:
    report = soak(SoakPlan(jobs=30, kills=14, queue_kills=2, interval_s=1.5, workers=2, seed=8))
    assert report.jobs >= 30
    assert report.kills.total() >= 14
    assert (report.lost, report.failed, report.duplicates, report.differing) == (0, 0, 0, 0)
    assert report.run_again > 0
