"""A service that requires a key, on a real server, whose jobs a thread runs."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from redis import Redis

from cleave.settings import Settings
from helpers.servers import remembered_segmentations, serving, working
from service.keys import key_digest, new_key
from worker.jobs.store.store import JobStore

KEY = new_key()


@pytest.fixture
def api_key() -> str:
    return KEY


@pytest.fixture
def settings(tmp_path: Path, queue_url: str, connection: Redis) -> Settings:
    del connection  # an empty queue
    return Settings(data_dir=tmp_path / "data", redis_url=queue_url, api_keys=f"artist:{key_digest(KEY)}")


@pytest.fixture
def url(settings: Settings, store: JobStore) -> Iterator[str]:
    """The URL of a running service."""
    with remembered_segmentations(), working(store, settings), serving(settings) as http:
        yield str(http.base_url)


@pytest.fixture
def idle_url(settings: Settings) -> Iterator[str]:
    """The URL of a service that has no worker."""
    with serving(settings) as http:
        yield str(http.base_url)
