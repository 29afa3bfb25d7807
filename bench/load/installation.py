"""`cleave serve` on a folder of its own, for the time of a measurement."""

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import httpx

_STARTED = re.compile(r"listening on +(http://\S+)")
_READY_WITHIN_S = 180.0  # kernels may have to be compiled
_SETTINGS = {"CLEAVE_LOG_LEVEL": "error"}


@dataclass(frozen=True, slots=True)
class Installation:
    url: str
    pid: int  # of the supervisor
    data_dir: Path

    @property
    def log(self) -> Path:
        """What its processes have written to the standard error."""
        return self.data_dir.with_suffix(".log")

    def children(self, word: str) -> list[int]:
        """The process ids of the supervisor's children whose command line holds a word."""
        return [pid for pid in children_of(self.pid) if word.encode() in _command_line(pid)]

    def work_horses(self) -> list[int]:
        return [pid for worker in self.children("worker.process") for pid in children_of(worker)]

    def service_pid(self) -> int:
        """The process that answers HTTP."""
        (pid,) = self.children("service.host.http_server")
        return pid


@contextmanager
def installed(workers: int, settings: Mapping[str, str] = _SETTINGS) -> Iterator[Installation]:
    """An installation that is ready for jobs; where it has no workers, one that answers."""
    with tempfile.TemporaryDirectory(prefix="cleave-load-", ignore_cleanup_errors=True) as folder:
        data_dir = Path(folder) / "data"
        environment = os.environ | dict(settings) | {"CLEAVE_DATA_DIR": str(data_dir)}
        with data_dir.with_suffix(".log").open("wb") as log:
            process = subprocess.Popen(
                cleave("serve", "--port", "0", "--workers", str(workers)),
                env=environment,
                stdout=subprocess.PIPE,
                stderr=log,
                text=True,
            )
        try:
            yield _ready(process, data_dir, needs_workers=workers > 0)
        finally:
            process.terminate()
            process.wait(60)
            assert process.stdout is not None
            process.stdout.close()


@contextmanager
def more_workers(installation: Installation, count: int, queue: str) -> Iterator[None]:
    """Workers of one queue beside an installation."""
    url = f"unix://{installation.data_dir}/queue/queue.sock"
    process = subprocess.Popen(
        cleave("worker", "--redis-url", url, "--queue", queue, "--workers", str(count)),
        env=os.environ | _SETTINGS | {"CLEAVE_DATA_DIR": str(installation.data_dir)},
        stdout=subprocess.DEVNULL,
    )
    try:
        yield
    finally:
        process.terminate()
        process.wait(60)


def cleave(*arguments: str) -> list[str]:
    """The command `cleave` of this checkout."""
    return [sys.executable, "-m", "service.commands", *arguments]


def children_of(pid: int) -> list[int]:
    with suppress(FileNotFoundError, ProcessLookupError):
        return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    return []


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
    gives_up_at = time.monotonic() + _READY_WITHIN_S
    while not _answers(f"{url}/readyz" if needs_workers else f"{url}/healthz"):
        if time.monotonic() > gives_up_at:
            raise RuntimeError("cleave serve did not become ready")
        time.sleep(0.2)
    return Installation(url, process.pid, data_dir)


def _answers(url: str) -> bool:
    try:
        return httpx.get(url, timeout=30).status_code == 200
    except httpx.TransportError:
        return False
