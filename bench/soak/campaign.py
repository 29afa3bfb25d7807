"""Runs a soak: the same jobs without and with faults, and the difference."""

import random
import time
from collections import Counter, deque
from concurrent.futures import Future
from dataclasses import dataclass, field
from datetime import datetime
from itertools import pairwise
from threading import Event

from bench.load.installation import Installation, installed
from bench.soak.faults import WORKER_DEATHS, inflict, schedule
from bench.soak.work import LARGE_JOB_BYTES, Client, Submitted
from worker.jobs.attempts import Attempt
from worker.jobs.job import now

_SETTLED_WITHIN_S = 180.0  # several times the longest pause in the table of bench/RESULTS.md
_DROPPED = "the outcome of this run is dropped"  # in a log message of worker.process.perform

_SETTINGS = {
    # More than the kills of one job: a worker cannot distinguish a kill from a job that crashes its work-horse.
    "CLEAVE_MAX_ATTEMPTS": "25",
    "CLEAVE_LARGE_JOB_BYTES": str(LARGE_JOB_BYTES),
    "CLEAVE_LOG_LEVEL": "info",
}


@dataclass(frozen=True, slots=True)
class SoakPlan:
    """The size of a soak. The defaults were set by hand; bench/RESULTS.md has the outcome with them."""

    jobs: int = 300  # at least
    kills: int = 100  # of work-horses, workers, both at once, the janitor and the service
    queue_kills: int = 6  # of the queue server, one of them with the loss of its files
    interval_s: float = 2.0  # mean time between two kills
    workers: int = 4  # one of them for the large jobs
    seed: int = 1
    settings: dict[str, str] = field(default_factory=dict)  # more settings of the service


@dataclass(frozen=True, slots=True)
class SoakReport:
    """The outcome of a soak."""

    jobs: int
    kills: Counter[str]
    lost: int  # accepted jobs that do not exist any more or have no outcome
    failed: int
    duplicates: int  # jobs that were not submitted
    differing: int  # results whose bytes differ from those of a run without faults
    run_again: int  # jobs with more than one attempt
    dropped: int  # attempts that ended after the job already had an outcome
    resumed_s: float  # longest time from the death of a worker to the next attempt of its job
    settled_s: float  # from the last kill to the end of the last job

    @property
    def is_clean(self) -> bool:
        return not (self.lost or self.failed or self.duplicates or self.differing)


def soak(plan: SoakPlan) -> SoakReport:
    """Run the same jobs without and with faults."""
    settings = _SETTINGS | plan.settings
    with installed(plan.workers, settings) as installation:
        expected = _without_faults(installation)
    with installed(plan.workers, settings) as installation:
        return _with_faults(installation, plan, expected)


def _without_faults(installation: Installation) -> dict[int, str]:
    """Return the digest of the result of each different mesh."""
    client = Client(installation)
    submitted = [client.submit(number) for number in range(client.different)]
    client.wait_for_end(_SETTLED_WITHIN_S)
    digests = client.results()
    client.close()
    return {job.mesh: digests[job.id] for job in submitted}


def _with_faults(installation: Installation, plan: SoakPlan, expected: dict[int, str]) -> SoakReport:
    client, rng = Client(installation), random.Random(plan.seed)
    faults = schedule(plan.kills, plan.queue_kills, rng)
    is_over = Event()  # until then there are jobs to kill
    submission = client.submit_evenly(plan.jobs, plan.interval_s * len(faults), is_over)
    try:
        done = _inflict_all(installation, faults, plan.interval_s, submission, rng)
    finally:
        is_over.set()
    ended_at = time.monotonic()
    submitted = submission.result()
    statuses = client.wait_for_end(_SETTLED_WITHIN_S)
    settled_s = time.monotonic() - ended_at
    digests, attempts = client.results(), client.attempts()
    client.close()
    ids = {job.id for job in submitted}
    return SoakReport(
        jobs=len(ids),
        kills=done.kills,
        lost=sum(statuses.get(job_id) not in ("succeeded", "failed") for job_id in ids),
        failed=sum(status == "failed" for status in statuses.values()),
        duplicates=len(statuses.keys() - ids),
        differing=sum(digests.get(job.id, expected[job.mesh]) != expected[job.mesh] for job in submitted),
        run_again=sum(len(runs) > 1 for runs in attempts),
        dropped=installation.log.read_text(errors="replace").count(_DROPPED),
        resumed_s=longest_pause_s(attempts, done.worker_deaths),
        settled_s=settled_s,
    )


@dataclass(frozen=True, slots=True)
class _Faults:
    """The faults that were inflicted."""

    kills: Counter[str]  # by kind
    worker_deaths: list[datetime]


def _inflict_all(
    installation: Installation,
    faults: list[str],
    interval_s: float,
    submission: "Future[list[Submitted]]",
    rng: random.Random,
) -> _Faults:
    """Inflict all faults, one after the other; stop if the submission fails."""
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
            left.insert(2, fault)  # there was no such process: try again later
    return _Faults(kills, deaths)


def longest_pause_s(attempts: list[list[Attempt]], deaths: list[datetime]) -> float:
    """Return the longest time from the death of a worker to the next attempt of its job.

    An attempt without an end is assigned to the first death after its start.
    """
    pauses = [0.0]
    for runs in attempts:
        for run, following in pairwise(runs):
            between = [at for at in deaths if run.started_at < at < following.started_at]
            if run.ended_at is None and between:
                pauses.append((following.started_at - between[0]).total_seconds())
    return max(pauses)
