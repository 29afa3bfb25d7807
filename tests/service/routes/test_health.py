"""Readiness, and what remains available if Redis is down."""

from collections.abc import Callable

import httpx

from cleave.settings import Settings
from helpers.api import problem, submit
from helpers.jobs import sphere
from worker.jobs.queue.compilation import Compilation, publish_compilation
from worker.jobs.queue.queue import JobQueue


def test_a_service_is_ready_when_queue_store_and_worker_are(client: httpx.Client, queue: JobQueue) -> None:
    assert client.get("/healthz").json() == {"status": "ok"}
    waiting = client.get("/readyz")
    assert waiting.status_code == 503
    assert waiting.json() == {
        "ready": False,
        "queue": True,
        "store": True,
        "workers": 0,
        "missing": ["No worker for small jobs is ready.", "No worker for large jobs is ready."],
        "compilation": None,
    }
    for size in ("small", "large"):
        queue.connection.sadd(f"rq:workers:cleave:{size}", f"rq:worker:{size}")
        queue.connection.hset(f"rq:worker:{size}", "state", "idle")
    ready = client.get("/readyz")
    assert (ready.status_code, ready.json()["workers"]) == (200, 2)


def test_without_a_queue_results_are_served_and_submissions_refused(
    client_without_queue: httpx.Client, finished_job: Callable[..., str], client: httpx.Client, settings: Settings
) -> None:
    finished, waiting = finished_job(), submit(client)
    before = sorted(settings.data_dir.rglob("*"))
    refused = client_without_queue.post("/v1/jobs", files={"mesh": ("mesh.off", sphere(12))})
    problem(refused, 503, "queue_unavailable")
    assert int(refused.headers["Retry-After"]) > 0
    assert sorted(settings.data_dir.rglob("*")) == before
    assert client_without_queue.get(finished).json()["status"] == "succeeded"
    assert client_without_queue.get(f"{finished}/labels?segments=2").status_code == 200
    assert client_without_queue.get(waiting).json()["status"] == "queued"
    assert client_without_queue.post(f"{waiting}/cancel").json()["status"] == "canceled"
    assert client_without_queue.get("/readyz").json()["missing"][0] == "The queue server does not answer."
    assert client_without_queue.get("/healthz").status_code == 200


def test_a_compilation_is_told_by_the_readiness_and_by_waiting_jobs(client: httpx.Client, queue: JobQueue) -> None:
    job = submit(client)
    publish_compilation(queue.connection, Compilation(14, 52))
    readiness = client.get("/readyz").json()
    assert readiness["compilation"] == {"done": 14, "count": 52}
    assert readiness["missing"][-1] == "The workers are compiling, once: 14 of 52."
    assert client.get(job).json()["waits_for"] == "compiling, once: 14 of 52"
    publish_compilation(queue.connection, None)
    assert client.get("/readyz").json()["compilation"] is None
    assert client.get(job).json()["waits_for"] is None
