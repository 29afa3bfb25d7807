"""A short day of a small team behind nginx: see ``bench.day.script``."""

import os
import shutil

import pytest

from bench.day.finding import render
from bench.day.script import DayPlan, day

pytestmark = [
    pytest.mark.timeout(600),  # for busy machines: webhooks may be sent again after half a minute
    pytest.mark.skipif(shutil.which("nginx") is None and "CI" not in os.environ, reason="the test needs nginx"),
]


def test_nothing_is_lost_or_told_twice_and_nobody_sees_the_work_of_others() -> None:
    settings = {"CLEAVE_LEASE_S": "3", "CLEAVE_SHUTDOWN_GRACE_S": "0.5"}
    findings = day(DayPlan(members=2, long_jobs=1, long_faces=10_000, settings=settings))
    assert not any(finding.is_wrong for finding in findings), render(findings)
    amounts = {finding.name: finding.count for finding in findings if not finding.must_be_zero}
    assert min(amounts.values()) > 0, amounts
