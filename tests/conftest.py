"""A store and a queue server for every test that asks for one; the same random examples in every run."""

import os
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings
from hypothesis.configuration import set_hypothesis_home_dir
from redis import Redis

from helpers.buckets import CREDENTIALS, s3_server
from helpers.waiting import wait_until
from service.host.queue_server import embedded_queue_server
from worker.jobs.queue.connection import connect
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.opening import open_folder
from worker.jobs.store.store import JobStore

# No deadline: the first call of a kernel compiles it. Nothing is left in the folder where the tests run.
settings.register_profile("repeatable", derandomize=True, deadline=None, database=None)
settings.load_profile("repeatable")
_HYPOTHESIS = tempfile.TemporaryDirectory(prefix="hypothesis-")
set_hypothesis_home_dir(_HYPOTHESIS.name)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--contract-examples",
        type=int,
        default=int(os.environ.get("CONTRACT_EXAMPLES", "20")),
        help="requests that schemathesis makes up for every operation (CONTRACT_EXAMPLES, or 20)",
    )


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the tests of the browser last: what drives it keeps an event loop running in the main thread."""
    items.sort(key=lambda item: "browser" in item.path.parts)


def pytest_unconfigure() -> None:
    _HYPOTHESIS.cleanup()


@pytest.fixture
def store(tmp_path: Path) -> JobStore:
    return open_folder(tmp_path / "data")


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 2 MB."""
    folder = tmp_path / "data"
    folder.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", str(folder)], capture_output=True)
    if mounted.returncode:
        pytest.skip("a file system cannot be mounted here")
    yield folder
    subprocess.run(["umount", "--lazy", str(folder)], check=True)


@pytest.fixture(scope="session")
def s3_url() -> Iterator[str]:
    """A bucket for this run of the tests, with the credentials for it in the environment."""
    with pytest.MonkeyPatch.context() as patch, s3_server() as (url, _):
        for name, value in CREDENTIALS.items():
            patch.setenv(name, value)
        yield url


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
    with connect(queue_url, timeout_s=10.0) as connection:
        connection.flushall()
        yield connection


@pytest.fixture
def queue(connection: Redis) -> JobQueue:
    return JobQueue(connection)
