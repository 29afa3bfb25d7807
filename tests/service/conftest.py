"""The application on a real server, without workers: tests do their work by hand."""

import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
import uvicorn
from asking import AGAIN
from redis import Redis

from service.app import create_app
from support import sphere
from worker.settings import Settings
from worker.store import LocalStore
from worker.tasks import perform


@pytest.fixture
def settings(tmp_path: Path, queue_url: str, connection: Redis) -> Settings:
    del connection  # an empty queue
    return Settings(data_dir=tmp_path / "data", redis_url=queue_url, max_upload_bytes=200_000)


@contextmanager
def serving(settings: Settings) -> Iterator[httpx.Client]:
    """A client of an application that runs in a thread of this process."""
    listening = socket.create_server(("127.0.0.1", 0))
    server = uvicorn.Server(uvicorn.Config(create_app(settings), log_config=None))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    try:
        with httpx.Client(base_url=f"http://127.0.0.1:{listening.getsockname()[1]}", timeout=30) as client:
            yield client
    finally:
        server.should_exit = True
        thread.join()
        listening.close()


@pytest.fixture
def client(settings: Settings) -> Iterator[httpx.Client]:
    with serving(settings) as client:
        yield client


@pytest.fixture
def client_without_queue(settings: Settings, tmp_path: Path) -> Iterator[httpx.Client]:
    """A client of a second application on the same store, whose queue server is down."""
    with serving(settings.model_copy(update={"redis_url": f"unix://{tmp_path}/nowhere.sock"})) as client:
        yield client


@pytest.fixture
def finished_job(client: httpx.Client, settings: Settings, store: LocalStore) -> Callable[..., str]:
    """Submit a mesh, do the work, and give the path of the job."""

    def submit_and_perform(mesh: bytes | None = None) -> str:
        answer = client.post("/v1/jobs", files={"mesh": ("mesh.off", mesh or sphere(12))}, headers=AGAIN)
        assert answer.status_code == 202, answer.text
        perform(store, settings, answer.json()["id"], lambda *_: None)
        return answer.headers["Location"]

    return submit_and_perform
