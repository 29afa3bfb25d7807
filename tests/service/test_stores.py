"""The service with a bucket, an unavailable store and a full disk."""

import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import problem, submit, traces
from helpers.buckets import below, s3_server
from helpers.jobs import sphere
from helpers.servers import serving
from worker.jobs.job import new_job_id
from worker.jobs.store.opening import open_store
from worker.jobs.store.store import JobStore
from worker.process.perform import perform


@pytest.fixture
def in_a_bucket(settings: Settings, s3_url: str) -> Settings:
    return settings.model_copy(update={"store_url": below(s3_url, new_job_id())})


@pytest.fixture
def bucket_client(in_a_bucket: Settings) -> Iterator[httpx.Client]:
    with serving(in_a_bucket) as client:
        yield client


def finished(client: httpx.Client, store: JobStore, settings: Settings) -> str:
    path = submit(client)
    perform(store, settings, path.rpartition("/")[2], lambda *_: None)
    return path


def test_a_job_can_be_stored_in_a_bucket(bucket_client: httpx.Client, in_a_bucket: Settings) -> None:
    client, store = bucket_client, open_store(in_a_bucket)
    path = finished(client, store, in_a_bucket)
    assert client.get(path).json()["status"] == "succeeded"
    assert [job["links"]["self"] for job in client.get("/v1/jobs").json()["jobs"]] == [path]
    assert client.get(f"{path}/labels", params={"segments": 3}).json()["segments"] == 3
    streamed = client.get(f"{path}/result.cleave")
    redirected = client.get(f"{path}/result.cleave", params={"redirect": "true"})
    assert (streamed.status_code, redirected.status_code) == (200, 307)
    assert httpx.get(redirected.headers["Location"]).content == streamed.content
    assert client.delete(path).status_code == 204
    problem(client.get(f"{path}/labels"), 410, "job_deleted")
    assert httpx.get(redirected.headers["Location"]).status_code == 404
    assert traces(in_a_bucket.data_dir) == []
    assert list((in_a_bucket.data_dir / "cache").iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize("fault", [signal.SIGSTOP, signal.SIGKILL])
def test_an_unavailable_store_is_reported_within_two_seconds(
    settings: Settings, s3_url: str, fault: signal.Signals
) -> None:
    del s3_url  # the credentials
    with s3_server() as (url, server), serving(settings.model_copy(update={"store_url": url})) as client:
        path = submit(client)
        os.kill(server.pid, fault)
        for ask in (lambda: client.get(path), lambda: client.post("/v1/jobs", content=sphere(12))):
            began_at = time.monotonic()
            answer = ask()
            assert time.monotonic() - began_at < 4  # on a busy machine
            problem(answer, 503, "store_unavailable")
            assert int(answer.headers["Retry-After"]) > 0
        assert client.get("/healthz").status_code == 200
        assert client.get("/readyz").json()["missing"][0] == "The store cannot be written."


def test_an_upload_larger_than_the_disk_is_refused_and_leaves_no_files(settings: Settings, small_disk: Path) -> None:
    assert settings.data_dir == small_disk
    with serving(settings.model_copy(update={"max_upload_bytes": 2**24})) as client:
        for form in ({"content": bytes(2**22)}, {"files": {"mesh": ("mesh.off", bytes(2**22))}}):
            answer = client.post("/v1/jobs", **form)  # type: ignore[arg-type]
            problem(answer, 507, "insufficient_storage")
            assert answer.headers["Retry-After"] == "60"
            assert traces(small_disk) == []
        assert client.post("/v1/jobs", content=sphere(12)).status_code == 202


def test_a_job_can_be_deleted_on_a_full_disk(settings: Settings, small_disk: Path) -> None:
    with serving(settings) as client:
        path = submit(client)
        status = os.statvfs(small_disk)
        (small_disk / "ballast").write_bytes(bytes(status.f_bavail * status.f_frsize))
        problem(client.post("/v1/jobs", content=sphere(12)), 507, "insufficient_storage")
        problem(client.post(f"{path}/cancel"), 507, "insufficient_storage")
        assert client.delete(path).status_code == 204
        problem(client.get(path), 410, "job_deleted")
        assert traces(small_disk) == []
