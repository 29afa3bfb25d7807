"""The first start of `cleave serve`: it answers and takes jobs while kernels are compiled."""

import os
import signal
from pathlib import Path

import httpx

from helpers.installation import Installation
from helpers.jobs import sphere
from helpers.storage.kernels import copy_kernels
from helpers.waiting import wait_until
from segcore.kernels import GROUPS, CompilationProgress


class FirstInstallation(Installation):
    """One whose kernels another process compiles, as far as its workers can see."""

    def __init__(self, cache: Path) -> None:
        super().__init__()
        self.settings = Installation.settings | {"NUMBA_CACHE_DIR": str(cache), "CLEAVE_LOG_LEVEL": "info"}

    def is_ready(self) -> bool:
        try:
            return httpx.get(f"{self.url}/healthz", timeout=30).status_code == 200
        except httpx.TransportError:
            return False


def test_a_job_that_is_sent_during_the_compilation_says_so_and_succeeds_after_it(tmp_path: Path) -> None:
    place = copy_kernels(tmp_path)
    with place.locked(lambda: False):
        place.write(frozenset(), CompilationProgress(14, 52))
        with FirstInstallation(tmp_path) as installation:
            job = installation.submit(sphere(20))
            wait_until(lambda: installation.get(job).json()["waits_for"] == "compiling, once: 14 of 52")
            assert installation.get(job).json()["status"] == "queued"
            assert installation.get("/readyz").json()["compilation"] == {"done": 14, "count": 52}
            for worker in installation.children("worker.process"):
                os.kill(worker, signal.SIGKILL)
            place.write(frozenset(GROUPS), CompilationProgress(52, 52))
            wait_until(lambda: installation.status(job) == "succeeded", within_s=60)
            assert installation.get(job).json()["waits_for"] is None
            assert installation.get("/readyz").json()["compilation"] is None
