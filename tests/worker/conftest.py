"""A store on every kind of storage, and worker and janitor processes."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from redis import Redis

from helpers.buckets import below
from helpers.jobs import SMALL
from helpers.processes import StartWorker
from segcore.kernels import compile_kernels
from worker.jobs.job import new_job_id
from worker.jobs.size_class import SizeClass
from worker.jobs.store.opening import open_folder, open_url
from worker.jobs.store.store import JobStore

STORAGES = ("local", "memory", "s3")


@pytest.fixture(params=STORAGES)
def any_store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[JobStore]:
    """An empty store: in a folder, in the memory of the process, or in a bucket."""
    match request.param:
        case "local":
            yield open_folder(tmp_path / "data")
        case "memory":
            yield open_url("memory://", tmp_path / "data", 2**20)
        case _:
            yield open_url(below(request.getfixturevalue("s3_url"), new_job_id()), tmp_path / "data", 2**20)


@pytest.fixture
def start_worker(tmp_path: Path, queue_url: str, connection: Redis) -> Iterator[StartWorker]:
    """Start worker processes with given settings; they are killed after the test."""
    del connection  # an empty queue
    compile_kernels()  # so that the work-horses are the only children of a worker
    started: list[subprocess.Popen[bytes]] = []

    def start(
        size: SizeClass = SMALL, program: tuple[str, str] = ("-m", "worker.process"), **environment: str
    ) -> "subprocess.Popen[bytes]":
        settings = {"CLEAVE_DATA_DIR": str(tmp_path / "data"), "CLEAVE_REDIS_URL": queue_url}
        process = subprocess.Popen(
            [sys.executable, *program, size],
            env=os.environ | settings | environment,
            start_new_session=True,
        )
        started.append(process)
        return process

    yield start
    for process in started:
        process.kill()
        process.wait()


@pytest.fixture
def start_janitor(tmp_path: Path, queue_url: str) -> Iterator[Callable[[], None]]:
    """Start a janitor process; it is killed after the test."""
    started: list[subprocess.Popen[bytes]] = []

    def start() -> None:
        settings = {"CLEAVE_DATA_DIR": str(tmp_path / "data"), "CLEAVE_REDIS_URL": queue_url}
        started.append(subprocess.Popen([sys.executable, "-m", "worker.janitor"], env=os.environ | settings))

    yield start
    for process in started:
        process.kill()
        process.wait()
