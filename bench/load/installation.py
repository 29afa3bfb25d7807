"""Starts `cleave serve` with its own data folder for a measurement."""

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path

import httpx

from bench.checkout import HERE
from worker.process.spare import WAITING_NAME

_STARTED = re.compile(r"listening on +(http://\S+)")
_READY_WITHIN_S = 180.0  # enough to compile all kernels on a busy machine
_STOPPED_WITHIN_S = 60  # more than the grace period of the workers
_SETTINGS = {"CLEAVE_LOG_LEVEL": "error"}


@dataclass(frozen=True, slots=True)
class Installation:
    """A running `cleave serve`."""

    url: str
    pid: int  # of the supervisor
    data_dir: Path
    version: Path = HERE  # the root of its checkout

    @property
    def log(self) -> Path:
        """The standard error of its processes."""
        return self.data_dir.with_suffix(".log")

    def children(self, word: str) -> list[int]:
        """Return the ids of the child processes of the supervisor whose command line contains a word."""
        return [pid for pid in children_of(self.pid) if word.encode() in _command_line(pid)]

    def work_horses(self) -> list[int]:
        """Return the ids of the child processes of the workers that run a job."""
        return [pid for worker in self.children("worker.process") for pid in children_of(worker) if runs_a_job(pid)]

    def service_pid(self) -> int:
        """Return the id of the HTTP server."""
        (pid,) = self.children("service.host.http_server")
        return pid


@contextmanager
def installed(workers: int, settings: Mapping[str, str] = _SETTINGS, version: Path = HERE) -> Iterator[Installation]:
    """Start an installation and wait until it is ready for jobs, or for requests if it has no workers.

    ``version`` is the root of a checkout.
    """
    with (
        tempfile.TemporaryDirectory(prefix="cleave-load-", ignore_cleanup_errors=True) as folder,
        installed_in(Path(folder) / "data", workers, settings, version) as installation,
    ):
        yield installation


@contextmanager
def installed_in(
    data_dir: Path, workers: int, settings: Mapping[str, str] = _SETTINGS, version: Path = HERE
) -> Iterator[Installation]:
    """Start an installation with a data folder, which may have jobs already; its log lies beside the folder."""
    environment = environment_of(version) | dict(settings) | {"CLEAVE_DATA_DIR": str(data_dir)}
    with data_dir.with_suffix(".log").open("wb") as log:
        process = subprocess.Popen(
            cleave("serve", "--port", "0", "--workers", str(workers)),
            cwd=version,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=log,
            text=True,
        )
    try:
        yield replace(_ready(process, data_dir, needs_workers=workers > 0), version=version)
    finally:
        process.terminate()
        process.wait(_STOPPED_WITHIN_S)
        assert process.stdout is not None
        process.stdout.close()


@contextmanager
def more_workers(installation: Installation, count: int, queue: str) -> Iterator[None]:
    """Start more workers of one queue for an installation."""
    url = f"unix://{installation.data_dir}/queue/queue.sock"
    process = subprocess.Popen(
        cleave("worker", "--redis-url", url, "--queue", queue, "--workers", str(count)),
        cwd=installation.version,
        env=environment_of(installation.version) | _SETTINGS | {"CLEAVE_DATA_DIR": str(installation.data_dir)},
        stdout=subprocess.DEVNULL,
    )
    try:
        yield
    finally:
        process.terminate()
        process.wait(_STOPPED_WITHIN_S)


def environment_of(version: Path) -> dict[str, str]:
    """Return the environment in which Python imports the packages of a checkout."""
    return os.environ | {"PYTHONPATH": str(version)}


def cleave(*arguments: str) -> list[str]:
    """Return the command line of `cleave` of the checkout that is the working directory."""
    return [sys.executable, "-m", "service.commands", *arguments]


def children_of(pid: int) -> list[int]:
    """Return the ids of the child processes of a process."""
    with suppress(FileNotFoundError, ProcessLookupError):
        return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    return []


def runs_a_job(pid: int) -> bool:
    """Whether a child process of a worker runs a job or an edit, rather than waiting for one."""
    with suppress(FileNotFoundError, ProcessLookupError):
        return Path(f"/proc/{pid}/comm").read_text().strip() != WAITING_NAME
    return False


def _command_line(pid: int) -> bytes:
    with suppress(FileNotFoundError, ProcessLookupError):
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    return b""


def _ready(process: "subprocess.Popen[str]", data_dir: Path, *, needs_workers: bool) -> Installation:
    assert process.stdout is not None
    url = None
    while url is None:
        line = process.stdout.readline()
        if not line:
            raise RuntimeError("cleave serve ended before it listened")
        found = _STARTED.search(line)
        url = found[1] if found else None
    deadline = time.monotonic() + _READY_WITHIN_S
    while not _is_ok(f"{url}/readyz" if needs_workers else f"{url}/healthz"):
        if time.monotonic() > deadline:
            raise RuntimeError("cleave serve did not become ready")
        time.sleep(0.2)
    return Installation(url, process.pid, data_dir)


def _is_ok(url: str) -> bool:
    try:
        return httpx.get(url, timeout=30).status_code == 200
    except httpx.TransportError:
        return False
