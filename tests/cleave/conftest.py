"""The service for its client: an application on a real server, whose jobs a thread of the tests does."""

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from redis import Redis
from servers import serving

from worker.settings import Settings
from worker.store import JobStore
from worker.tasks import perform


@pytest.fixture
def settings(tmp_path: Path, queue_url: str, connection: Redis) -> Settings:
    del connection  # an empty queue
    return Settings(data_dir=tmp_path / "data", redis_url=queue_url)


@pytest.fixture
def url(settings: Settings, store: JobStore) -> Iterator[str]:
    """The URL of a service that works."""
    stop = threading.Event()

    def work() -> None:
        while not stop.wait(0.01):
            for job_id in store.unfinished():
                perform(store, settings, job_id, lambda *_: None)

    worker = threading.Thread(target=work)
    worker.start()
    with serving(settings) as http:
        yield str(http.base_url)
    stop.set()
    worker.join()
