"""Fixtures for the commands."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from cleave.settings import Settings
from helpers.jobs import sphere
from helpers.queue_servers import StartServer, queue_servers
from helpers.servers import serving, working
from service.commands.main import main
from worker.jobs.store.store import JobStore


@pytest.fixture(scope="session")
def ball(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a mesh, ball.off, and its result, ball.cleave."""
    folder = tmp_path_factory.mktemp("ball")
    (folder / "ball.off").write_bytes(sphere(12))
    assert main(["segment", str(folder / "ball.off"), "--result", str(folder / "ball.cleave")]) == 0
    return folder


@pytest.fixture
def mesh(tmp_path: Path) -> Path:
    """A file of sphere(12)."""
    path = tmp_path / "ball.off"
    path.write_bytes(sphere(12))
    return path


@pytest.fixture
def url(settings: Settings, store: JobStore) -> Iterator[str]:
    """The URL of a service whose jobs are performed in a thread."""
    with working(store, settings), serving(settings) as http:
        yield str(http.base_url)


@pytest.fixture
def start_server(tmp_path: Path) -> Iterator[StartServer]:
    """Start queue servers with options; the result is their URL."""
    with queue_servers(tmp_path) as start:
        yield start
