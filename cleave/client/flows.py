"""The operations of the client without I/O: each is a generator that yields requests and is sent the responses."""

import json
import secrets
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias, TypeVar

import httpx
import numpy as np

from cleave.client.documents import Job, Segmentation, job_from
from cleave.client.errors import JobEnded, RequestRefused
from cleave.client.multipart import form_of

POLL_S = 20.0  # of one long poll: well below the 60 s after which nginx, by default, ends a request
_PAGE = 100  # jobs; the server allows up to 200

Value = TypeVar("Value")


@dataclass(frozen=True, slots=True, kw_only=True)
class Call:
    """One idempotent request."""

    method: str
    path: str
    params: Mapping[str, str | list[str]] = field(default_factory=dict)
    headers: Mapping[str, str] = field(default_factory=dict)
    body: Sequence[Path | bytes] = ()  # its pieces, files and bytes
    wait_s: float = 0.0  # for which the server was asked to hold back the response


Flow: TypeAlias = Generator[Call, httpx.Response, Value]


@dataclass(frozen=True, slots=True, kw_only=True)
class Submission:
    """A mesh and the options of its job."""

    mesh: Path | bytes
    companions: Mapping[str, Path] = field(default_factory=dict)  # by their paths relative to the mesh
    file_name: str | None = None
    format: str | None = None
    unit: str | None = None
    up: str | None = None
    parameters: Mapping[str, object] = field(default_factory=dict)
    webhook: str | None = None
    idempotency_key: str = field(default_factory=lambda: secrets.token_urlsafe(16))
    recompute: bool = False

    def call(self, wait_s: float, level: Mapping[str, str] | None = None) -> Call:
        name = self.file_name or (self.mesh.name if isinstance(self.mesh, Path) else None)
        if name is not None:  # HTTP cannot carry the bytes of a name that is not UTF-8
            name = name.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
        params = {
            "file_name": name,
            "format": self.format,
            "unit": self.unit,
            "up": self.up,
            "parameters": json.dumps(dict(self.parameters)) if self.parameters else None,
            "webhook": self.webhook,
            **(level or {}),
        }
        content_type, body = "application/octet-stream", [self.mesh]
        if self.companions:
            content_type, body = form_of({name or "mesh": self.mesh, **self.companions}, self.idempotency_key)
        return Call(
            method="POST",
            path="/v1/jobs",
            params={key: value for key, value in params.items() if value is not None},
            headers={
                "Content-Type": content_type,
                "Idempotency-Key": self.idempotency_key,
                **({"Prefer": f"wait={wait_s:.0f}"} if wait_s else {}),
                **({"Cache-Control": "no-cache"} if self.recompute else {}),
            },
            body=body,
            wait_s=wait_s,
        )


def version() -> Flow[str]:
    return str((yield Call(method="GET", path="/v1/formats")).json()["version"])


def submit(submission: Submission) -> Flow[Job]:
    return job_from((yield submission.call(0.0)).json())


def level_of(
    segments: int | None, granularity: float | None, revision: int | Literal["latest"] | None = None
) -> dict[str, str]:
    """Return the query parameters for a number of segments, a granularity or a revision."""
    wanted = {"segments": segments, "granularity": granularity, "revision": revision}
    return {name: str(value) for name, value in wanted.items() if value is not None}


def segment(submission: Submission, level: Mapping[str, str]) -> Flow[Segmentation]:
    """Submit a mesh and wait for its labels, in one round trip if the job ends within the first poll."""
    document = (yield submission.call(POLL_S, level)).json()
    job = job_from(document)
    if document.get("labels") is not None:
        return Segmentation(job, document["segments"], np.array(document["labels"], dtype=np.int32))
    job = yield from wait(job.id)
    return (yield from labels(job, level))


def get(job_id: str, wait_s: float = 0.0) -> Flow[Job]:
    params = {"wait": f"{wait_s:g}"} if wait_s else {}
    response = yield Call(method="GET", path=f"/v1/jobs/{job_id}", params=params, wait_s=wait_s)
    return job_from(response.json())


def wait(job_id: str) -> Flow[Job]:
    """Wait until a job has ended, without a time limit."""
    while True:
        job = yield from get(job_id, POLL_S)
        if job.has_ended:
            return job


def labels(job: Job, level: Mapping[str, str]) -> Flow[Segmentation]:
    if job.has_ended and job.status != "succeeded":
        raise JobEnded(job)
    params = {"format": "raw", **level}
    response = yield Call(method="GET", path=f"/v1/jobs/{job.id}/labels", params=params)
    if not job.has_ended:
        job = yield from get(job.id)
    of_faces = np.frombuffer(response.content, dtype="<i4").astype(np.int32)
    return Segmentation(job, int(of_faces.max()) + 1, of_faces)  # a mesh has faces, and no segment is empty


def hierarchy(job_id: str) -> Flow[dict[str, Any]]:
    document: dict[str, Any] = (yield Call(method="GET", path=f"/v1/jobs/{job_id}/hierarchy")).json()
    return document


def content(job_id: str, result: str, params: Mapping[str, str | list[str]]) -> Flow[bytes]:
    return (yield Call(method="GET", path=f"/v1/jobs/{job_id}/{result}", params=params)).content


def page(status: str | None, cursor: str | None) -> Flow[tuple[list[Job], str | None]]:
    """Return a page of jobs, newest first, and the cursor of the next page."""
    wanted = {"limit": str(_PAGE), "status": status, "cursor": cursor}
    params = {key: value for key, value in wanted.items() if value is not None}
    document = (yield Call(method="GET", path="/v1/jobs", params=params)).json()
    return [job_from(job) for job in document["jobs"]], document["next_cursor"]


def cancel(job_id: str) -> Flow[Job]:
    return job_from((yield Call(method="POST", path=f"/v1/jobs/{job_id}/cancel")).json())


def delete(job_id: str) -> Flow[None]:
    yield Call(method="DELETE", path=f"/v1/jobs/{job_id}")


def refusal(response: httpx.Response) -> RequestRefused:
    """Return the problem in a response that has been read."""
    retry = response.headers.get("Retry-After", "")
    retry_s = float(retry) if retry.isdigit() else None
    try:
        problem = response.json()
        return RequestRefused(response.status_code, str(problem["code"]), str(problem["detail"]), retry_s)
    except (ValueError, KeyError, TypeError):
        sentence = f"The response was {response.status_code} {response.reason_phrase}: is this a Cleave server?"
        return RequestRefused(response.status_code, "not_understood", sentence, retry_s)
