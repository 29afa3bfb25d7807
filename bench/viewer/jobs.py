"""Jobs of a running service, for benchmarks of what comes after them."""

from __future__ import annotations

import io
import time
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from segcore.mesh import Mesh

_TIMEOUT_S = 600.0
_PAUSE_S = 0.3


def finished_job(url: str, name: str, mesh: Mesh) -> str:
    """The id of a job of the service at ``url`` that has cut a mesh.

    Raises
    ------
    BenchmarkError
        Where the service does not answer or the job has no result.
    """
    import httpx

    from segcore.io import write_mesh

    content = io.BytesIO()
    write_mesh(content, mesh, "ply")
    try:
        answer = httpx.post(f"{url}/v1/jobs", files={"mesh": (name, content.getvalue())}, timeout=_TIMEOUT_S)
        job = answer.raise_for_status().json()
        gives_up_at = time.monotonic() + _TIMEOUT_S
        while job["status"] in ("queued", "running") and time.monotonic() < gives_up_at:
            time.sleep(_PAUSE_S)
            job = httpx.get(f"{url}/v1/jobs/{job['id']}", timeout=_TIMEOUT_S).raise_for_status().json()
    except httpx.HTTPError as error:
        raise BenchmarkError(f"The service at {url} does not do its work: {error}") from error
    if job["status"] != "succeeded":
        raise BenchmarkError(f"The job of {name} is {job['status']}: see the log of the service.")
    return str(job["id"])
