"""Measures jobs per second by the number of workers, and memory by the number of jobs."""

import time
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import httpx

from bench.checkout import HERE
from bench.load.installation import Installation, installed, more_workers
from bench.load.meshes import wavy_torus

_FINISHED_WITHIN_S = 1800.0  # many times what 200 jobs take one worker, see bench/RESULTS.md
_PROCESSES = {"service": "service.host.http_server", "worker": "worker.process", "janitor": "worker.janitor"}


@dataclass(frozen=True, slots=True)
class Throughput:
    """The time of some jobs with a number of workers."""

    workers: int
    seconds: float  # from the start of the first job to the end of the last

    def jobs_per_s(self, jobs: int) -> float:
        return jobs / self.seconds


def throughput(workers: int, jobs: int, faces: int, version: Path = HERE) -> Throughput:
    """Submit different jobs of one size, then start the workers and wait until all jobs have succeeded."""
    with (
        installed(workers=0, version=version) as installation,
        httpx.Client(base_url=installation.url, timeout=120) as client,
    ):
        for number in range(jobs):
            _submit(client, wavy_torus(faces, 3 + number % 5), number)
        with more_workers(installation, workers, "small"):
            finished = _finished(client, jobs)
    began_at = min(datetime.fromisoformat(job["started_at"]) for job in finished)
    ended_at = max(datetime.fromisoformat(job["finished_at"]) for job in finished)
    return Throughput(workers, (ended_at - began_at).total_seconds())


def memory(jobs: int, samples: int, faces: int) -> Iterator[tuple[int, dict[str, float]]]:
    """Yield numbers of jobs with the resident megabytes of each process.

    The first of the ``samples`` is after a tenth of the jobs, the last after all, the others evenly between them.
    """
    warm = jobs // 10
    marks = [warm + round(number * (jobs - warm) / (samples - 1)) for number in range(samples)]
    mesh = wavy_torus(faces)
    with installed(workers=2) as installation, httpx.Client(base_url=installation.url, timeout=120) as client:
        submitted = 0
        for mark in marks:
            for number in range(submitted, mark):
                path = _submit(client, mesh, number)
                client.get(path)
                client.get("/v1/jobs", params={"limit": 5})
            submitted = mark
            for job in _finished(client, mark)[:20]:
                client.get(f"/v1/jobs/{job['id']}/labels", params={"segments": 5})
            yield mark, _resident_mb(installation)


def _submit(client: httpx.Client, mesh: bytes, seed: int) -> str:
    response = client.post(
        "/v1/jobs",
        content=mesh,
        params={"parameters": f'{{"seed": {seed}}}'},
        headers={"Content-Type": "model/ply", "Cache-Control": "no-cache"},
    )
    return str(response.raise_for_status().headers["Location"])


def _finished(client: httpx.Client, count: int) -> list[dict[str, str]]:
    """Wait until this number of jobs has succeeded, and return them."""
    deadline = time.monotonic() + _FINISHED_WITHIN_S
    while time.monotonic() < deadline:
        jobs = list(_succeeded(client))
        if len(jobs) >= count:
            return jobs
        time.sleep(2.0)
    raise RuntimeError(f"{count} jobs did not succeed within {_FINISHED_WITHIN_S:.0f} s")


def _succeeded(client: httpx.Client) -> Iterator[dict[str, str]]:
    query: dict[str, str | int] | None = {"status": "succeeded", "limit": 100}
    while query is not None:
        page = client.get("/v1/jobs", params=query).raise_for_status().json()
        yield from page["jobs"]
        query = {**query, "cursor": page["next_cursor"]} if page["next_cursor"] else None


def _resident_mb(installation: Installation) -> dict[str, float]:
    """Return the largest resident memory among the processes of each kind."""
    return {
        name: max(_resident_bytes(pid) for pid in installation.children(word)) / 1e6
        for name, word in _PROCESSES.items()
    }


def _resident_bytes(pid: int) -> int:
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmRSS"))
