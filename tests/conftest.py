"""A store and a queue server for every test that asks for one."""

import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from redis import Redis

from service.queue_server import embedded_queue_server
from support import wait_until
from worker.queue import JobQueue, connect_impatiently
from worker.store import LocalStore


@pytest.fixture
def store(tmp_path: Path) -> LocalStore:
    return LocalStore(tmp_path / "data")


@pytest.fixture(scope="session")
def queue_url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A queue server for this run of the tests."""
    server = embedded_queue_server(tmp_path_factory.mktemp("queue"))
    with subprocess.Popen(server.command) as process:
        wait_until(server.is_answering)
        yield server.url
        process.terminate()


@pytest.fixture
def connection(queue_url: str) -> Iterator[Redis]:
    with connect_impatiently(queue_url, timeout_s=10.0) as connection:
        connection.flushall()
        yield connection


@pytest.fixture
def queue(connection: Redis) -> JobQueue:
    return JobQueue(connection)
