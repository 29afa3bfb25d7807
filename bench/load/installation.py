"""`cleave serve` on a folder of its own, for the time of a measurement."""

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx

_STARTED = re.compile(r"listening on +(http://\S+)")
_READY_WITHIN_S = 180.0  # kernels may have to be compiled


@dataclass(frozen=True, slots=True)
class Installation:
    url: str
    pid: int  # of the supervisor

    def service_pid(self) -> int:
        """The process that answers HTTP."""
        children = Path(f"/proc/{self.pid}/task/{self.pid}/children").read_text().split()
        for child in children:
            if b"service.server" in Path(f"/proc/{child}/cmdline").read_bytes():
                return int(child)
        raise RuntimeError("the service has no process that answers HTTP")


@contextmanager
def installed(workers: int) -> Iterator[Installation]:
    """An installation that is ready for jobs."""
    with tempfile.TemporaryDirectory(prefix="cleave-load-", ignore_cleanup_errors=True) as folder:
        process = subprocess.Popen(
            [sys.executable, "-m", "service.cli", "serve", "--port", "0", "--workers", str(workers)],
            env=os.environ | {"CLEAVE_DATA_DIR": folder, "CLEAVE_LOG_LEVEL": "error"},
            stdout=subprocess.PIPE,
            text=True,
        )
        try:
            yield _ready(process)
        finally:
            process.terminate()
            process.wait(60)


def _ready(process: "subprocess.Popen[str]") -> Installation:
    assert process.stdout is not None
    url = None
    while url is None:
        line = process.stdout.readline()
        if not line:
            raise RuntimeError("cleave serve ended before it listened")
        found = _STARTED.search(line)
        url = found[1] if found else None
    gives_up_at = time.monotonic() + _READY_WITHIN_S
    while httpx.get(f"{url}/readyz", timeout=30).status_code != 200:
        if time.monotonic() > gives_up_at:
            raise RuntimeError("cleave serve did not become ready")
        time.sleep(0.2)
    return Installation(url, process.pid)
