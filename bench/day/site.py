"""The processes of the day: `cleave serve`, whose version can change, and workers on another host."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import httpx
from redis import Redis

from bench.day.proxies import free_port
from bench.errors import BenchmarkError
from bench.load.installation import children_of, cleave, runs_a_job
from worker.jobs.queue.workers import live_workers

WORKERS = 2  # of the service
_READY_WITHIN_S = 240.0  # far more than a start takes on a busy machine
_COMPILE = "import segcore; segcore.warm_up()"
_STOPPED_WITHIN_S = 60.0


@dataclass(slots=True)
class Site:
    """A data folder and the processes that use it; every start may be one of another version."""

    folder: Path
    settings: Mapping[str, str]
    port: int = field(default_factory=free_port)
    _serving: "subprocess.Popen[bytes] | None" = None
    _host: "subprocess.Popen[bytes] | None" = None

    @property
    def data_dir(self) -> Path:
        return self.folder / "data"

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def _queue_url(self) -> str:
        return f"unix://{self.data_dir}/queue/queue.sock"

    def start(self, version: Path) -> None:
        """Start the service of a version, the root of its checkout, and wait until it is ready.

        Its kernels are compiled first, in one process, so that the workers need not do so at the same time.

        Raises
        ------
        BenchmarkError
            If it does not become ready.
        """
        subprocess.run([sys.executable, "-c", _COMPILE], cwd=version, env=self._environment(version), check=True)
        self._serving = self._run(version, "serve", "--port", str(self.port), "--workers", str(WORKERS))
        deadline = time.monotonic() + _READY_WITHIN_S
        while not _is_ready(self.url):
            if time.monotonic() > deadline or self._serving.poll() is not None:
                raise BenchmarkError(f"cleave serve does not start: {self._last_words()}")
            time.sleep(0.1)

    def stop(self) -> None:
        """Stop the service as an operator does."""
        if self._serving is not None:
            self._serving.terminate()
            self._serving.wait(_STOPPED_WITHIN_S)

    def start_host(self, version: Path) -> None:
        """Start a worker for small jobs on another host."""
        arguments = ["--redis-url", self._queue_url, "--queue", "small", "--workers", "1"]
        self._host = self._run(version, "worker", *arguments)

    def workers(self) -> int:
        """Return the number of workers that are ready, on both hosts."""
        with Redis.from_url(self._queue_url) as connection:
            return len(live_workers(connection))

    def host_is_working(self) -> bool:
        """Whether the other host runs a job."""
        assert self._host is not None
        return any(runs_a_job(child) for process in children_of(self._host.pid) for child in children_of(process))

    def lose_host(self) -> None:
        """End all processes of the other host at once, as a loss of power does."""
        assert self._host is not None
        lost = [self._host.pid]
        for pid in lost:
            lost += children_of(pid)
        for number in (signal.SIGSTOP, signal.SIGKILL):  # stopped first, so that none sees the end of another one
            for pid in lost:
                with suppress(ProcessLookupError):
                    os.kill(pid, number)
        self._host.wait()

    def close(self) -> None:
        """End everything."""
        for process in (self._host, self._serving):
            if process is not None and process.poll() is None:
                process.terminate()
                process.wait(_STOPPED_WITHIN_S)

    def _run(self, version: Path, *arguments: str) -> "subprocess.Popen[bytes]":
        with (self.folder / "log").open("ab") as log:
            return subprocess.Popen(
                cleave(*arguments),
                cwd=version,
                env=self._environment(version),
                stdout=subprocess.DEVNULL,
                stderr=log,
            )

    def _environment(self, version: Path) -> dict[str, str]:
        own = {"CLEAVE_DATA_DIR": str(self.data_dir), "PYTHONPATH": str(version)}
        return os.environ | dict(self.settings) | own

    def _last_words(self) -> str:
        return (self.folder / "log").read_text(errors="replace").strip()[-500:] or "it says nothing"


def _is_ready(url: str) -> bool:
    try:
        return httpx.get(f"{url}/readyz", timeout=30).status_code == 200
    except httpx.TransportError:
        return False
