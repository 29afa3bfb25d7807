"""Submits the jobs of a soak: a few different meshes repeatedly, each request with retries."""

import hashlib
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from threading import Event

import httpx

from bench.load.installation import Installation
from bench.load.meshes import wavy_torus
from bench.load.retries import until_answered
from cleave.settings import Settings
from worker.jobs.attempts import Attempt
from worker.jobs.store.opening import open_store

LARGE_JOB_BYTES = 300_000  # between the sizes of the meshes, so that the last of them are large jobs
_FACES = (1_000, 2_500, 5_000, 8_000, 12_000, 25_000, 40_000)
_WAVES = (3, 4, 5)
_POLL_S = 0.2
_ENDED = ("succeeded", "failed", "canceled")


@dataclass(frozen=True, slots=True)
class Submitted:
    """One job of a soak."""

    mesh: int  # index of the mesh
    path: str  # of the job, from the header Location

    @property
    def id(self) -> str:
        return self.path.rpartition("/")[2]


class Client:
    """A client that retries. Every job has its own idempotency key, so that a retry creates no second job."""

    def __init__(self, installation: Installation) -> None:
        self._installation = installation
        self._meshes = [wavy_torus(faces, waves) for faces in _FACES for waves in _WAVES]
        self._http = httpx.Client(base_url=installation.url, timeout=30)

    @property
    def different(self) -> int:
        """The number of different meshes."""
        return len(self._meshes)

    def submit(self, number: int) -> Submitted:
        """Submit a job, with retries until it is accepted."""
        mesh = number % self.different
        headers = {"Content-Type": "model/ply", "Idempotency-Key": f"soak-{number}", "Cache-Control": "no-cache"}
        response = until_answered(
            lambda: self._http.post("/v1/jobs", content=self._meshes[mesh], headers=headers), {200, 202}
        )
        return Submitted(mesh, response.headers["Location"])

    def submit_evenly(self, count: int, duration_s: float, is_over: Event) -> Future[list[Submitted]]:
        """Submit jobs one after the other in a thread, evenly spread over a duration, and more until an event."""

        def work() -> list[Submitted]:
            began_at, submitted = time.monotonic(), list[Submitted]()
            while len(submitted) < count or not is_over.is_set():
                time.sleep(max(0.0, began_at + len(submitted) * duration_s / count - time.monotonic()))
                submitted.append(self.submit(len(submitted)))
            return submitted

        pool = ThreadPoolExecutor(1)
        future = pool.submit(work)
        pool.shutdown(wait=False)
        return future

    def statuses(self) -> dict[str, str]:
        """Return the status of every job by its id."""
        found: dict[str, str] = {}
        query: dict[str, str | int] = {"limit": 100}
        while True:
            page = until_answered(lambda: self._http.get("/v1/jobs", params=query), {200}).json()
            found |= {job["id"]: job["status"] for job in page["jobs"]}
            if page["next_cursor"] is None:
                return found
            query["cursor"] = page["next_cursor"]

    def wait_for_end(self, within_s: float) -> dict[str, str]:
        """Wait until every job has ended, at most ``within_s`` seconds, and return their statuses."""
        deadline = time.monotonic() + within_s
        statuses = self.statuses()
        while time.monotonic() < deadline and not set(statuses.values()) <= set(_ENDED):
            time.sleep(_POLL_S)
            statuses = self.statuses()
        return statuses

    def results(self) -> dict[str, str]:
        """Return a digest of the stored result of every succeeded job by its id."""
        store = open_store(Settings(data_dir=self._installation.data_dir))
        digests: dict[str, str] = {}
        for job_id, status in self.statuses().items():
            if status == "succeeded":
                with store.results.open(job_id) as result:
                    digests[job_id] = hashlib.sha256(result.read()).hexdigest()
        return digests

    def attempts(self) -> list[list[Attempt]]:
        """Return the attempts of every job."""
        store = open_store(Settings(data_dir=self._installation.data_dir))
        return [store.records.attempts(job_id) for job_id in self.statuses()]

    def close(self) -> None:
        """Close the connections."""
        self._http.close()
