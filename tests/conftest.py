"""A store and a queue server for every test that asks for one; the same random examples in every run."""

import gc
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from hypothesis import settings
from hypothesis.configuration import set_hypothesis_home_dir
from redis import Redis
from xdist.remote import Producer
from xdist.scheduler import LoadScopeScheduling

from helpers.buckets import CREDENTIALS, s3_server
from helpers.waiting import wait_until
from service.host.queue_server import embedded_queue_server
from worker.jobs.queue.connection import connect
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.opening import open_folder
from worker.jobs.store.store import JobStore

# One thread per process, like the workers of an installation: threads of BLAS that wait for each other use up the
# processors that the other processes of the tests need.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

# Hundreds of processes import the packages, which are compiled only once if bytecode may be written.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# No deadline: the first call of a kernel compiles it. Nothing is left in the folder where the tests run; all processes
# and the next runs find the constants of unchanged modules in one other folder.
settings.register_profile("repeatable", derandomize=True, deadline=None, database=None)
settings.register_profile("everyday", settings.get_profile("repeatable"), max_examples=20)
set_hypothesis_home_dir(Path(tempfile.gettempdir(), f"cleave-hypothesis-{os.getuid()}"))

_BROWSER = "tests/browser/"
_SECOND_HALF = "test_list"  # the browser tests from this name on take about as long as those before it
_SEPARATE = {"tests/end_to_end/test_faults.py", "tests/worker/process/test_process.py"}
_EVERYDAY = "not slow"  # the marker expression of the everyday run
_SLOW = (
    "tests/end_to_end/*",
    "tests/browser/*",
    "tests/fuzz/*",
    "bench/commands/test_digests.py",
    "bench/commands/test_paper.py",
    "bench/commands/test_princeton.py",
    "bench/commands/test_scale.py",
    "bench/commands/test_train.py",
    "bench/paper/*",
    "bench/princeton/test_evaluation.py",
    "house/test_language.py",
    "integrations/blender/test_blender.py",
    "segcore/test_laws.py",
    "segcore/io/test_memory.py",
    "segcore/io/test_round_trips.py",
    "service/commands/test_outputs.py",
    "service/commands/test_segment.py",
    "service/host/test_http_protocol.py",
    "service/openapi/test_contract.py",
    "worker/jobs/store/test_crashes.py",
    "worker/process/test_outage.py",
    "worker/process/test_process.py",
    "worker/process/test_process_store.py",
)
# Measured with --durations=0; the order only shortens the run.
_LONGEST = (
    "end_to_end/test_soak.py",
    "browser/*",
    "end_to_end/test_faults.py",
    "worker/process/test_process.py",
    "end_to_end/*",
    "bench/commands/test_train.py",
    "worker/*",
    "service/openapi/test_contract.py",
    "segcore/test_laws.py",
)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--contract-examples",
        type=int,
        default=int(os.environ.get("CONTRACT_EXAMPLES", "20")),
        help="requests that schemathesis makes up for every operation (CONTRACT_EXAMPLES, or 20)",
    )


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Two processes more than there are processors, because many tests wait; this process alone for a single file."""
    if len(config.args) == 1 and config.args[0].partition("::")[0].endswith(".py"):
        return 0
    return 2 + (len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)


def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> LoadScopeScheduling:
    return _FileByFile(config, log)


class _FileByFile(LoadScopeScheduling):
    """All tests of a file run in one process, except in files whose tests share nothing.

    The browser tests run in three processes, each with a browser and a service that its tests share.
    """

    def _split_scope(self, nodeid: str) -> str:
        path = nodeid.partition("::")[0]
        if path in _SEPARATE:
            return nodeid
        if not path.startswith(_BROWSER):
            return path
        name = path.removeprefix(_BROWSER)
        return f"{_BROWSER}{'edit' if '/' in name else 'first' if name < _SECOND_HALF else 'second'}"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Start the files that take longest first, and mark the tests that are left out with ``-m "not slow"``."""
    items.sort(key=lambda item: _order(item.path))
    for item in items:
        if _is_slow(item.path):
            item.add_marker("slow")


def pytest_configure(config: pytest.Config) -> None:
    """Draw fewer examples in the everyday run."""
    settings.load_profile("everyday" if config.option.markexpr == _EVERYDAY else "repeatable")


@pytest.hookimpl(tryfirst=True)
def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile the kernels once, before the processes of the tests start, each of which would compile some of them."""
    if session.config.getoption("numprocesses", None):
        command = [sys.executable, "-m", "segcore.kernels", "--quiet"]
        subprocess.run(command, cwd=session.config.rootpath, check=True)


def pytest_collection_finish() -> None:
    """Keep the tests, which are hundreds of thousands of objects, out of garbage collections."""
    gc.freeze()


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Import no slow file in the everyday run."""
    return (config.option.markexpr == _EVERYDAY and _is_slow(collection_path)) or None


@cache
def _is_slow(path: Path) -> bool:
    return path.suffix == ".py" and any(path.match(pattern) for pattern in _SLOW)


@cache
def _order(path: Path) -> int:
    """The position of the first pattern that matches a file; files that match none come in the middle."""
    return next((i for i, pattern in enumerate(_LONGEST) if path.match(pattern)), len(_LONGEST))


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
