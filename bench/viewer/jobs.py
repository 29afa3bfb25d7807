"""Submits jobs to a running service for the benchmark of the viewer."""

from __future__ import annotations

import io
import time
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from segcore.mesh import Mesh

_TIMEOUT_S = 600.0  # of a request, and of a job with 1.3 million faces on a busy machine
_PAUSE_S = 0.3  # between two polls


def finished_job(url: str, name: str, mesh: Mesh) -> str:
    """Segment a mesh with the service at ``url`` and return the id of the job.

    Raises
    ------
    BenchmarkError
        If the service does not respond, or the job has no result.
    """
    import httpx

    from segcore.io import write_mesh

    content = io.BytesIO()
    write_mesh(content, mesh, "ply")
    try:
        response = httpx.post(f"{url}/v1/jobs", files={"mesh": (name, content.getvalue())}, timeout=_TIMEOUT_S)
        job = response.raise_for_status().json()
        deadline = time.monotonic() + _TIMEOUT_S
        while job["status"] in ("queued", "running") and time.monotonic() < deadline:
            time.sleep(_PAUSE_S)
            job = httpx.get(f"{url}/v1/jobs/{job['id']}", timeout=_TIMEOUT_S).raise_for_status().json()
    except httpx.HTTPError as error:
        raise BenchmarkError(f"The service at {url} does not segment meshes: {error}") from error
    if job["status"] != "succeeded":
        raise BenchmarkError(f"The job of {name} is {job['status']}: see the log of the service.")
    return str(job["id"])
