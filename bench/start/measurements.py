"""Starts of one version of this repository: of the command `cleave`, and of the service until its first result."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import httpx

_URL = re.compile(r"listening on +(http://\S+)")
_POLL_S = 0.02
_LONGEST_S = 600.0  # of a first start on a busy machine; set by hand

HELP, SEGMENT = "cleave --help", "cleave segment"
ANSWER, RESULT = "cleave serve: /healthz", "cleave serve: first result"
COLD, WARM = "kernels not compiled", "kernels compiled"


@dataclass(frozen=True, slots=True)
class Seconds:
    wall: float
    cpu: float  # of the process and of those that it has started and awaited; nan if it goes on


@dataclass(frozen=True, slots=True)
class Version:
    """A checkout, with a cache for its kernels that no other version has."""

    folder: Path
    cache: Path

    @property
    def environment(self) -> dict[str, str]:
        own = {"PYTHONPATH": str(self.folder), "NUMBA_CACHE_DIR": str(self.cache), "OPENBLAS_NUM_THREADS": "1"}
        return {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"} | own

    def command(self, *arguments: str) -> list[str]:
        return [sys.executable, "-m", "service.commands", *arguments]

    def run(self, *arguments: str) -> Seconds:
        """Run a command to its end."""
        begin = time.perf_counter()
        process = subprocess.Popen(
            self.command(*arguments),
            cwd=self.folder,
            env=self.environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            raise RuntimeError(f"cleave {' '.join(arguments)} ended with {process.returncode} in {self.folder}")
        return Seconds(time.perf_counter() - begin, usage.ru_utime + usage.ru_stime)

    def serve(self, mesh: Path) -> dict[str, Seconds]:
        """Start the service, send it a mesh when it answers, and stop it when the job has succeeded."""
        with tempfile.TemporaryDirectory(prefix="cleave-start-", ignore_cleanup_errors=True) as data:
            begin = time.perf_counter()
            process = subprocess.Popen(
                self.command("serve", "--port", "0", "--workers", "2"),
                cwd=self.folder,
                env=self.environment | {"CLEAVE_DATA_DIR": data, "CLEAVE_LOG_LEVEL": "error"},
                stdout=subprocess.PIPE,
                text=True,
            )
            try:
                url = _url_of(process)
                answer = _until_ok(f"{url}/healthz") - begin
                result = _until_succeeded(url, mesh) - begin
            finally:
                process.terminate()
                process.communicate()
        nan = float("nan")
        return {ANSWER: Seconds(answer, nan), RESULT: Seconds(result, nan)}


def starts(version: Version, mesh: Path, kernels: str) -> Iterator[tuple[str, Seconds]]:
    """Yield every start once; if ``COLD``, the cache of the version must be empty, and is filled by the first one."""
    if kernels == WARM:
        yield HELP, version.run("--help")
    yield SEGMENT, version.run("segment", str(mesh))
    if kernels == COLD:
        version = Version(version.folder, Path(tempfile.mkdtemp(dir=version.cache.parent)))
    yield from version.serve(mesh).items()


def _url_of(process: subprocess.Popen[str]) -> str:
    assert process.stdout is not None
    for line in process.stdout:
        found = _URL.search(line)
        if found:
            return found[1]
    raise RuntimeError("cleave serve ended before it listened")


def _until_ok(url: str) -> float:
    deadline = time.perf_counter() + _LONGEST_S
    while time.perf_counter() < deadline:
        try:
            if httpx.get(url, timeout=30).is_success:
                return time.perf_counter()
        except httpx.TransportError:
            pass
        time.sleep(_POLL_S)
    raise RuntimeError(f"{url} does not answer")


def _until_succeeded(url: str, mesh: Path) -> float:
    deadline = time.perf_counter() + _LONGEST_S
    sent = httpx.post(f"{url}/v1/jobs", files={"mesh": (mesh.name, mesh.read_bytes())}, timeout=60)
    job: Mapping[str, object] = sent.raise_for_status().json()
    while job["status"] != "succeeded":
        if time.perf_counter() > deadline or job["status"] == "failed":
            raise RuntimeError(f"the job is {job['status']}")
        time.sleep(0.1)
        job = httpx.get(f"{url}/v1/jobs/{job['id']}", timeout=60).json()
    return time.perf_counter()
