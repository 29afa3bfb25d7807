"""The measurements of the load command; bench/RESULTS.md has the limit of each."""

import re
import statistics
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import httpx

from bench.load.installation import Installation
from bench.load.meshes import wavy_torus

_POLLS = Path(__file__).with_name("polls.lua")
_CONNECTIONS = 75  # 300 requests a second with the delay in polls.lua
_EAGER_CONNECTIONS = 16


def keep_busy(client: httpx.Client, jobs: int) -> list[str]:
    """Submit jobs that take longer than the measurement, and return their paths."""
    mesh = wavy_torus(100_000)
    return [
        str(
            client.post(
                "/v1/jobs",
                files={"mesh": ("busy.ply", mesh)},
                # Large values, with which a job takes seconds.
                data={"parameters": f'{{"seed": {seed}, "clusters": 20000, "max_segments": 400}}'},
            ).headers["Location"]
        )
        for seed in range(jobs)
    ]


def polls(installation: Installation, path: str, seconds: int) -> str:
    """Poll a status with wrk, a little more than 300 times a second."""
    command = ["wrk", "-t1", f"-c{_CONNECTIONS}", f"-d{seconds}s", "--latency", "--timeout", "10s", "-s", str(_POLLS)]
    return _summary(subprocess.run([*command, installation.url + path], capture_output=True, text=True, check=True))


def _summary(done: subprocess.CompletedProcess[str]) -> str:
    rate = _find(r"Requests/sec:\s+(\S+)", done.stdout)
    p50, p99 = _find(r"50%\s+(\S+)", done.stdout), _find(r"99%\s+(\S+)", done.stdout)
    errors = "".join(re.findall(r"(?:Socket errors|Non-2xx).*", done.stdout)) or "no error"
    return f"{rate} requests/s, median {p50}, p99 {p99}, {errors}"


def most_polls(installation: Installation, path: str, seconds: int) -> str:
    """Poll a status with wrk as often as it is answered."""
    command = ["wrk", "-t1", f"-c{_EAGER_CONNECTIONS}", f"-d{seconds}s", "--latency", "--timeout", "10s"]
    return _summary(subprocess.run([*command, installation.url + path], capture_output=True, text=True, check=True))


def uploads(client: httpx.Client, count: int) -> str:
    """Measure the time from the first byte of a 1 MB mesh to the response that it is queued."""
    mesh = wavy_torus(52_000)
    times_s = []
    for number in range(count):
        began_at = time.perf_counter()
        response = client.post("/v1/jobs", content=mesh + bytes(number + 1), headers={"Content-Type": "model/ply"})
        times_s.append(time.perf_counter() - began_at)
        response.raise_for_status()
        client.delete(response.headers["Location"])
    p95 = statistics.quantiles(times_s, n=20)[-1]
    return f"{len(mesh) / 1e6:.2f} MB, median {1000 * statistics.median(times_s):.0f} ms, p95 {1000 * p95:.0f} ms"


def upload_memory(installation: Installation, client: httpx.Client, megabytes: int) -> str:
    """Measure the growth of the peak memory of the service during a large upload."""

    def body() -> Iterator[bytes]:
        for _ in range(megabytes):
            yield bytes(1_000_000)

    Path(f"/proc/{installation.service_pid()}/clear_refs").write_text("5")  # resets the peak, see proc(5)
    before = _peak_bytes(installation.service_pid())
    response = client.post("/v1/jobs", content=body(), headers={"Content-Type": "model/stl"})
    response.raise_for_status()
    grown = _peak_bytes(installation.service_pid()) - before
    client.delete(response.headers["Location"])
    return f"{megabytes} MB raise it by {grown / 2**20:.1f} MiB"


def levels(client: httpx.Client, faces: int, form: str) -> str:
    """Measure requests for labels at new numbers of segments; the first one also opens the result."""
    response = client.post("/v1/jobs", content=wavy_torus(faces), headers={"Content-Type": "model/ply"})
    path = response.headers["Location"]
    while client.get(path, params={"wait": 60}).json()["finished_at"] is None:
        pass
    times_s = []
    for segments in range(2, 22):
        began_at = time.perf_counter()
        client.get(f"{path}/labels", params={"segments": segments, "format": form}).raise_for_status()
        times_s.append(time.perf_counter() - began_at)
    client.delete(path)
    return (
        f"first {1000 * times_s[0]:.0f} ms, median {1000 * statistics.median(times_s):.0f} ms, "
        f"largest {1000 * max(times_s):.0f} ms"
    )


def _peak_bytes(pid: int) -> int:
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


def _find(pattern: str, text: str) -> str:
    found = re.search(pattern, text)
    return found[1] if found else "?"
