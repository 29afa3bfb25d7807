"""A service for the client: an application on a real server, whose jobs a thread runs."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from redis import Redis

from cleave.settings import Settings
from helpers.servers import serving, working
from worker.jobs.store.store import JobStore


@pytest.fixture
def settings(tmp_path: Path, queue_url: str, connection: Redis) -> Settings:
    del connection  # an empty queue
    return Settings(data_dir=tmp_path / "data", redis_url=queue_url)


@pytest.fixture
def url(settings: Settings, store: JobStore) -> Iterator[str]:
    """The URL of a running service."""
    with working(store, settings), serving(settings) as http:
        yield str(http.base_url)
