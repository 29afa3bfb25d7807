"""A whole installation as a user starts it, and what a test does to it."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any, ClassVar

import httpx
from redis import Redis

from helpers.processes import children_of
from helpers.waiting import wait_until

_STARTED = re.compile(r"listening on +(http://\S+)")
START_S = 120.0  # kernels may have to be compiled, on a busy machine


class Installation:
    """`cleave serve` on a data folder of its own. As a context it is gone afterwards, processes and files."""

    settings: ClassVar = {
        "CLEAVE_LEASE_S": "5",
        "CLEAVE_SHUTDOWN_GRACE_S": "0.5",
        "CLEAVE_LOG_LEVEL": "error",
        "CLEAVE_LARGE_JOB_BYTES": "1000000",  # sphere(100) is large
    }

    def __init__(self, workers: int = 2) -> None:
        self.data_dir = Path(tempfile.mkdtemp(prefix="cleave-test-"))
        self.workers = workers
        self.process: subprocess.Popen[str] | None = None
        self.url = ""

    def __enter__(self) -> "Installation":
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.kill()
        wait_until(lambda: not self.processes(), within_s=30)
        shutil.rmtree(self.data_dir)

    def command(self, *arguments: str) -> "subprocess.Popen[str]":
        """Start the command `cleave` with the data folder of this installation."""
        return subprocess.Popen(
            [sys.executable, "-m", "service.commands", *arguments],
            env=os.environ | self.settings | {"CLEAVE_DATA_DIR": str(self.data_dir)},
            stdout=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    def start(self) -> None:
        self.process = self.command("serve", "--port", "0", "--workers", str(self.workers))
        assert self.process.stdout is not None
        announcement = self._announcement()
        started = _STARTED.search(announcement)
        assert started, announcement
        self.url = started[1]
        wait_until(self.is_ready, within_s=START_S)

    def is_ready(self) -> bool:
        try:
            return httpx.get(f"{self.url}/readyz", timeout=30).status_code == 200
        except httpx.TransportError:
            return False

    def stop(self, number: signal.Signals = signal.SIGTERM) -> int:
        """Ask it to stop as a user or an operator does; the exit status."""
        assert self.process is not None
        self.process.send_signal(number)
        return self.wait()

    def wait(self) -> int:
        """Wait for its end; the exit status."""
        assert self.process is not None
        status = self.process.wait(60)
        self._close()
        return status

    def kill(self) -> None:
        """Kill the supervisor alone; the rest is the kernel's business."""
        if self.process is not None and self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self._close()

    def submit(self, mesh: bytes, parameters: str = "{}") -> str:
        """The path of a new job, which is computed whatever was computed before."""
        answer = httpx.post(
            f"{self.url}/v1/jobs",
            files={"mesh": ("mesh.off", mesh)},
            data={"parameters": parameters},
            headers={"Cache-Control": "no-cache"},
            timeout=60,
        )
        assert answer.status_code == 202, answer.text
        return str(answer.headers["Location"])

    def get(self, path: str) -> httpx.Response:
        return httpx.get(self.url + path, timeout=60)

    def status(self, path: str) -> str:
        return str(self.get(path).json()["status"])

    def statuses(self, paths: list[str]) -> set[str]:
        jobs = self.get("/v1/jobs?limit=100").json()["jobs"]
        statuses = {job["links"]["self"]: str(job["status"]) for job in jobs}
        return {statuses[path] for path in paths}

    def redis(self) -> Redis:
        return Redis.from_url(f"unix://{self.data_dir}/queue/queue.sock")

    def children(self, name: str) -> list[int]:
        """The process ids of the supervisor's children whose command line holds a word."""
        assert self.process is not None
        return [pid for pid in children_of(self.process.pid) if name in _command_line(pid)]

    def horses(self) -> list[int]:
        return [horse for worker in self.children("worker.process") for horse in children_of(worker)]

    def processes(self) -> list[int]:
        """Every process anywhere that belongs to this installation: its data folder is in their environment."""
        mark = f"CLEAVE_DATA_DIR={self.data_dir}".encode()
        return [pid for pid in _all_processes() if mark in _environment(pid).split(b"\0")]

    def files(self) -> list[str]:
        """The files of jobs and uploads, by their paths below the data folder."""
        folders = [self.data_dir / name for name in ("incoming", "jobs", "pending")]
        return sorted(str(path.relative_to(self.data_dir)) for folder in folders for path in folder.rglob("*"))

    def _announcement(self) -> str:
        assert self.process is not None
        assert self.process.stdout is not None
        lines = []
        for line in self.process.stdout:
            lines.append(line)
            if line.startswith("Ctrl-C"):
                break
        return "".join(lines)

    def _close(self) -> None:
        if self.process is not None and self.process.stdout is not None:
            self.process.stdout.close()


class LoggingInstallation(Installation):
    """One whose log is kept, as JSON."""

    settings = Installation.settings | {"CLEAVE_LOG_LEVEL": "info", "CLEAVE_LOG_FORMAT": "json"}

    def command(self, *arguments: str) -> "subprocess.Popen[str]":
        with self.log.open("ab") as log:
            return subprocess.Popen(
                [sys.executable, "-m", "service.commands", *arguments],
                env=os.environ | self.settings | {"CLEAVE_DATA_DIR": str(self.data_dir)},
                stdout=subprocess.PIPE,
                stderr=log,
                text=True,
                start_new_session=True,
            )

    @property
    def log(self) -> Path:
        return self.data_dir / "log"

    def lines(self) -> list[dict[str, Any]]:
        """Every line that is JSON: the queue server has a form of its own."""
        return [json.loads(line) for line in self.log.read_text().splitlines() if line.startswith("{")]


def _all_processes() -> list[int]:
    return [int(entry) for entry in os.listdir("/proc") if entry.isdigit()]


def _environment(pid: int) -> bytes:
    with suppress(OSError):
        return Path(f"/proc/{pid}/environ").read_bytes()
    return b""


def _command_line(pid: int) -> str:
    with suppress(OSError):
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    return ""
