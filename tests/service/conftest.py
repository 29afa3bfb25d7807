"""The application on a real server, without workers: tests call the task themselves."""

from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest
from redis import Redis

from cleave.settings import Settings
from helpers.api import AGAIN
from helpers.jobs import sphere
from helpers.servers import remembered_segmentations, serving
from worker.jobs.store.store import JobStore
from worker.process.perform import perform


@pytest.fixture(scope="session", autouse=True)
def segmentations() -> Iterator[None]:
    """Segment each small mesh once."""
    with remembered_segmentations():
        yield


@pytest.fixture
def settings(tmp_path: Path, queue_url: str, connection: Redis) -> Settings:
    del connection  # an empty queue
    return Settings(data_dir=tmp_path / "data", redis_url=queue_url, max_upload_bytes=200_000)


@pytest.fixture
def client(settings: Settings) -> Iterator[httpx.Client]:
    with serving(settings) as client:
        yield client


@pytest.fixture
def client_without_queue(settings: Settings, tmp_path: Path) -> Iterator[httpx.Client]:
    """A client of a second application on the same store, with a queue server that is down."""
    with serving(settings.model_copy(update={"redis_url": f"unix://{tmp_path}/nowhere.sock"})) as client:
        yield client


@pytest.fixture
def finished_job(client: httpx.Client, settings: Settings, store: JobStore) -> Callable[..., str]:
    """Return a function that submits a mesh, runs its job and returns the path of the job."""

    def submit_and_perform(mesh: bytes | None = None, **query: str) -> str:
        answer = client.post("/v1/jobs", files={"mesh": ("mesh.off", mesh or sphere(12))}, params=query, headers=AGAIN)
        assert answer.status_code == 202, answer.text
        perform(store, settings, answer.json()["id"], lambda *_: None)
        return answer.headers["Location"]

    return submit_and_perform
