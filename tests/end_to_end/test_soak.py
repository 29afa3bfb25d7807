"""A short soak: processes are killed at random, and everything comes out as if they were not."""

from bench.soak.campaign import SoakPlan, soak


def test_under_random_kills_nothing_is_lost_and_nothing_comes_out_otherwise() -> None:
    report = soak(SoakPlan(jobs=45, kills=14, queue_kills=2, interval_s=1.5, seed=8))
    assert report.jobs == 45
    assert report.kills.total() >= 14
    assert (report.lost, report.failed, report.duplicates, report.differing) == (0, 0, 0, 0)
    assert report.run_again > 0
