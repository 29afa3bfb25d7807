"""An installation that is started as a user starts it, and ways to submit to it, inspect it and stop it."""

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

from helpers.processes import children_of, horses_of
from helpers.waiting import wait_until
from segcore.kernels import compile_kernels

_STARTED = re.compile(r"listening on +(http://\S+)")
START_S = 120.0  # kernels may have to be compiled on a busy machine; set by hand


class Installation:
    """`cleave serve` in its own data folder. Leaving its context kills its processes and removes its files."""

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
        compile_kernels()  # so that the work-horses are the only children of a worker
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
        """Stop the supervisor by a signal and return its exit status."""
        assert self.process is not None
        self.process.send_signal(number)
        return self.wait()

    def wait(self) -> int:
        """Wait for the end of the supervisor and return its exit status."""
        assert self.process is not None
        status = self.process.wait(60)
        self._close()
        return status

    def kill(self) -> None:
        """Kill the supervisor only; the kernel then kills the other processes."""
        if self.process is not None and self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self._close()

    def submit(self, mesh: bytes, parameters: str = "{}") -> str:
        """Submit a mesh and return the path of its job, which never uses an earlier result."""
        answer = httpx.post(
            f"{self.url}/v1/jobs",
            files={"mesh": ("mesh.off", mesh)},
            data={"parameters": parameters},
            headers={"Cache-Control": "no-cache"},
            timeout=60,
        )
        assert answer.status_code in (200, 202), answer.text  # 200: the job has ended already
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
        """Return the process ids of the children of the supervisor whose command line contains a text."""
        assert self.process is not None
        return [pid for pid in children_of(self.process.pid) if name in _command_line(pid)]

    def horses(self) -> list[int]:
        """Return the process ids of the work-horses that run a job."""
        return [horse for worker in self.children("worker.process") for horse in horses_of(worker)]

    def processes(self) -> list[int]:
        """Return the process ids of this installation, which have its data folder in their environment."""
        mark = f"CLEAVE_DATA_DIR={self.data_dir}".encode()
        return [pid for pid in _all_processes() if mark in _environment(pid).split(b"\0")]

    def files(self) -> list[str]:
        """Return the files of jobs and uploads, relative to the data folder."""
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
    """An installation that writes a log in JSON, by default with all details."""

    settings = Installation.settings | {"CLEAVE_LOG_LEVEL": "debug", "CLEAVE_LOG_FORMAT": "json"}

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
        """Return the log lines, without those of the queue server, which are not JSON."""
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
