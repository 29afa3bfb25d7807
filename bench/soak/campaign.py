"""One soak: what comes out without faults, then the same with them, and the difference."""

import random
import time
from collections import Counter, deque
from concurrent.futures import Future
from dataclasses import dataclass, field
from datetime import datetime
from itertools import pairwise

from bench.load.installation import Installation, installed
from bench.soak.faults import WORKER_DEATHS, inflict, schedule
from bench.soak.work import LARGE_JOB_BYTES, Client, Submitted
from worker.jobs.attempts import Attempt
from worker.jobs.job import now

_SETTLED_WITHIN_S = 180.0
_DROPPED = "the outcome of this run is dropped"

# Kills are meant for jobs here, and no work-horse can tell one from the end of a job that is poison.
_SETTINGS = {
    "CLEAVE_MAX_ATTEMPTS": "25",
    "CLEAVE_LARGE_JOB_BYTES": str(LARGE_JOB_BYTES),
    "CLEAVE_LOG_LEVEL": "info",
}


@dataclass(frozen=True, slots=True)
class SoakPlan:
    jobs: int = 300
    kills: int = 100  # of work-horses, workers, both at once, the janitor and the service
    queue_kills: int = 6  # of the queue server, one of them with the loss of its files
    interval_s: float = 2.0  # between two kills, on average
    workers: int = 4  # that are started together, of which one is for the large jobs
    seed: int = 1
    settings: dict[str, str] = field(default_factory=dict)  # of the service, beside those of a soak


@dataclass(frozen=True, slots=True)
class SoakReport:
    jobs: int
    kills: Counter[str]
    lost: int  # accepted jobs that are not there any more, or have no outcome
    failed: int
    duplicates: int  # jobs that nobody submitted
    differing: int  # results whose bytes are not those of an undisturbed run
    run_again: int  # jobs that were begun more than once
    dropped: int  # runs that came to an end when the job had its outcome already
    resumed_s: float  # from the death of a worker to the next run of its job, at most
    settled_s: float  # from the last kill to the end of the last job

    @property
    def is_clean(self) -> bool:
        return not (self.lost or self.failed or self.duplicates or self.differing)


def soak(plan: SoakPlan) -> SoakReport:
    """Run the same jobs undisturbed and under fire."""
    settings = _SETTINGS | plan.settings
    with installed(plan.workers, settings) as installation:
        expected = _undisturbed(installation)
    with installed(plan.workers, settings) as installation:
        return _under_fire(installation, plan, expected)


def _undisturbed(installation: Installation) -> dict[int, str]:
    """The digest of the result of each different mesh."""
    client = Client(installation)
    submitted = [client.submit(number) for number in range(client.different)]
    client.wait_for_end(_SETTLED_WITHIN_S)
    digests = client.results()
    client.close()
    return {job.mesh: digests[job.id] for job in submitted}


def _under_fire(installation: Installation, plan: SoakPlan, expected: dict[int, str]) -> SoakReport:
    client, rng = Client(installation), random.Random(plan.seed)
    faults = schedule(plan.kills, plan.queue_kills, rng)
    submission = client.submit_evenly(plan.jobs, plan.interval_s * len(faults))
    kills, deaths = _fire(installation, faults, plan.interval_s, submission, rng)
    fired_at = time.monotonic()
    submitted = submission.result()
    statuses = client.wait_for_end(_SETTLED_WITHIN_S)
    settled_s = time.monotonic() - fired_at
    digests, attempts = client.results(), client.attempts()
    client.close()
    ids = {job.id for job in submitted}
    return SoakReport(
        jobs=len(ids),
        kills=kills,
        lost=sum(statuses.get(job_id) not in ("succeeded", "failed") for job_id in ids),
        failed=sum(status == "failed" for status in statuses.values()),
        duplicates=len(statuses.keys() - ids),
        differing=sum(digests.get(job.id, expected[job.mesh]) != expected[job.mesh] for job in submitted),
        run_again=sum(len(runs) > 1 for runs in attempts),
        dropped=installation.log.read_text(errors="replace").count(_DROPPED),
        resumed_s=longest_pause_s(attempts, deaths),
        settled_s=settled_s,
    )


def _fire(
    installation: Installation,
    faults: list[str],
    interval_s: float,
    submission: "Future[list[Submitted]]",
    rng: random.Random,
) -> tuple[Counter[str], list[datetime]]:
    """One fault after the other, all of them; how many of each were done, and when workers died."""
    kills: Counter[str] = Counter()
    deaths: list[datetime] = []
    left = deque(faults)
    for _ in range(2 * len(faults)):
        if not left or (submission.done() and submission.exception()):
            break
        fault = left.popleft()
        time.sleep(interval_s * rng.uniform(0.5, 1.5))
        if inflict(fault, installation, rng):
            kills[fault] += 1
            deaths += [now()] if fault in WORKER_DEATHS else []
        else:
            left.insert(2, fault)  # there was nothing to kill just now
    return kills, deaths


def longest_pause_s(attempts: list[list[Attempt]], deaths: list[datetime]) -> float:
    """From the death of a worker to the next run of its job; a run without an end is put down to the first after it."""
    pauses = [0.0]
    for runs in attempts:
        for run, following in pairwise(runs):
            between = [at for at in deaths if run.started_at < at < following.started_at]
            if run.ended_at is None and between:
                pauses.append((following.started_at - between[0]).total_seconds())
    return max(pauses)
