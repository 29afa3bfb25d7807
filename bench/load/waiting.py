"""Measures what the service adds to reading and segmenting a mesh, for a client that waits for the result."""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import httpx

from bench.load.installation import environment_of, installed
from bench.load.meshes import wavy_torus

# Reads the name of a file and a seed from each line, segments the file twice, and prints the shorter time.
_ALONE = """
import sys, time
import segcore
segcore.warm_up()
def took(path, seed):
    began_at = time.perf_counter()
    with open(path, "rb") as source:
        segcore.segment(segcore.read_mesh(source), segcore.SegmentationParameters(seed=seed))
    return time.perf_counter() - began_at
for line in sys.stdin:
    path, seed = line.split()
    print(min(took(path, int(seed)) for _ in range(2)), flush=True)
"""
_PAUSE_S = 0.5  # between two jobs, so that the work of one is over before the next


@dataclass(slots=True)
class Waiting:
    """The times of a version in seconds, one of each job."""

    alone_s: list[float] = field(default_factory=list)  # segcore in a process that has run before
    service_s: list[float] = field(default_factory=list)  # from the request to the response with the labels

    @property
    def overhead_ms(self) -> list[float]:
        return [1000 * (service - alone) for alone, service in zip(self.alone_s, self.service_s, strict=True)]

    def __str__(self) -> str:
        return (
            f"alone {1000 * statistics.median(self.alone_s):.0f} ms, overhead: median "
            f"{statistics.median(self.overhead_ms):.0f} ms, largest {max(self.overhead_ms):.0f} ms"
        )


def waiting(versions: Sequence[Path], faces: int, jobs: int) -> list[Waiting]:
    """Run jobs on the services of some versions in turn, and each mesh with the segcore of its version alone."""
    found = [Waiting() for _ in versions]
    with ExitStack() as stack:
        mesh = Path(stack.enter_context(TemporaryDirectory())) / "mesh.ply"
        services = [stack.enter_context(installed(1, version=root)).url for root in versions]
        alone = [stack.enter_context(_segmenter(root)) for root in versions]
        client = stack.enter_context(httpx.Client(timeout=120))
        for seed in range(jobs):
            mesh.write_bytes(wavy_torus(faces, 4 + seed % 3))
            for one, url, segmenter in zip(found, services, alone, strict=True):
                one.alone_s.append(_alone(segmenter, mesh, seed))
                one.service_s.append(_in_service(client, url, mesh.read_bytes(), seed))
                time.sleep(_PAUSE_S)
    return found


def _in_service(client: httpx.Client, url: str, mesh: bytes, seed: int) -> float:
    began_at = time.perf_counter()
    response = client.post(
        f"{url}/v1/jobs",
        content=mesh,
        params={"parameters": f'{{"seed": {seed}}}'},
        headers={"Content-Type": "model/ply", "Prefer": "wait=10"},
    )
    took_s = time.perf_counter() - began_at
    assert response.status_code == 200, response.text
    assert len(response.json()["labels"]) == response.json()["mesh"]["faces"]
    return took_s


@contextmanager
def _segmenter(version: Path) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        [sys.executable, "-c", _ALONE],
        cwd=version,
        env=environment_of(version),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    with process:
        yield process


def _alone(segmenter: subprocess.Popen[str], mesh: Path, seed: int) -> float:
    assert segmenter.stdin is not None
    assert segmenter.stdout is not None
    segmenter.stdin.write(f"{mesh} {seed}\n")
    segmenter.stdin.flush()
    return float(segmenter.stdout.readline())
