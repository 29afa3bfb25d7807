"""What a client does, without saying how bytes travel: each flow asks for calls and is sent their answers."""

import json
import secrets
from collections.abc import Generator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

import httpx
import numpy as np

from cleave.client.documents import Job, Segmentation, job_from
from cleave.client.errors import JobEnded, RequestRefused

POLL_S = 20.0  # how long the server may hold back an answer
_PAGE = 100

Value = TypeVar("Value")


@dataclass(frozen=True, slots=True, kw_only=True)
class Call:
    """One request; sending it twice does what sending it once does."""

    method: str
    path: str
    params: Mapping[str, str] = field(default_factory=dict)
    headers: Mapping[str, str] = field(default_factory=dict)
    body: Path | bytes | None = None
    patience_s: float = 0.0  # that the server was asked to hold back the answer


Flow: TypeAlias = Generator[Call, httpx.Response, Value]


@dataclass(frozen=True, slots=True, kw_only=True)
class Submission:
    """A mesh and what is wanted."""

    mesh: Path | bytes
    file_name: str | None = None
    format: str | None = None
    parameters: Mapping[str, object] = field(default_factory=dict)
    webhook: str | None = None
    idempotency_key: str = field(default_factory=lambda: secrets.token_urlsafe(16))
    recompute: bool = False

    def call(self, wait_s: float, level: Mapping[str, str] | None = None) -> Call:
        name = self.file_name or (self.mesh.name if isinstance(self.mesh, Path) else None)
        params = {
            "file_name": name,
            "format": self.format,
            "parameters": json.dumps(dict(self.parameters)) if self.parameters else None,
            "webhook": self.webhook,
            **(level or {}),
        }
        return Call(
            method="POST",
            path="/v1/jobs",
            params={key: value for key, value in params.items() if value is not None},
            headers={
                "Content-Type": "application/octet-stream",
                "Idempotency-Key": self.idempotency_key,
                **({"Prefer": f"wait={wait_s:.0f}"} if wait_s else {}),
                **({"Cache-Control": "no-cache"} if self.recompute else {}),
            },
            body=self.mesh,
            patience_s=wait_s,
        )


def submit(submission: Submission) -> Flow[Job]:
    return job_from((yield submission.call(0.0)).json())


def level_of(segments: int | None, granularity: float | None) -> dict[str, str]:
    """How the server is told how fine the segments are to be."""
    wanted = {"segments": segments, "granularity": granularity}
    return {name: str(value) for name, value in wanted.items() if value is not None}


def segment(submission: Submission, level: Mapping[str, str]) -> Flow[Segmentation]:
    """Submit and wait: one round trip where the server is quick enough."""
    document = (yield submission.call(POLL_S, level)).json()
    job = job_from(document)
    if document.get("labels") is not None:
        return Segmentation(job, document["segments"], np.array(document["labels"], dtype=np.int32))
    job = yield from wait(job.id)
    return (yield from labels(job, level))


def get(job_id: str, wait_s: float = 0.0) -> Flow[Job]:
    params = {"wait": f"{wait_s:g}"} if wait_s else {}
    answer = yield Call(method="GET", path=f"/v1/jobs/{job_id}", params=params, patience_s=wait_s)
    return job_from(answer.json())


def wait(job_id: str) -> Flow[Job]:
    """Wait for the end of a job, however long that takes."""
    while True:
        job = yield from get(job_id, POLL_S)
        if job.has_ended:
            return job


def labels(job: Job, level: Mapping[str, str]) -> Flow[Segmentation]:
    if job.has_ended and job.status != "succeeded":
        raise JobEnded(job)
    params = {"format": "raw", **level}
    answer = yield Call(method="GET", path=f"/v1/jobs/{job.id}/labels", params=params)
    if not job.has_ended:
        job = yield from get(job.id)
    of_faces = np.frombuffer(answer.content, dtype="<i4").astype(np.int32)
    return Segmentation(job, int(of_faces.max()) + 1, of_faces)  # there is no mesh without faces, no empty segment


def hierarchy(job_id: str) -> Flow[dict[str, Any]]:
    document: dict[str, Any] = (yield Call(method="GET", path=f"/v1/jobs/{job_id}/hierarchy")).json()
    return document


def page(status: str | None, cursor: str | None) -> Flow[tuple[list[Job], str | None]]:
    """Some jobs, newest first, and where the following begin."""
    wanted = {"limit": str(_PAGE), "status": status, "cursor": cursor}
    params = {key: value for key, value in wanted.items() if value is not None}
    document = (yield Call(method="GET", path="/v1/jobs", params=params)).json()
    return [job_from(job) for job in document["jobs"]], document["next_cursor"]


def cancel(job_id: str) -> Flow[Job]:
    return job_from((yield Call(method="POST", path=f"/v1/jobs/{job_id}/cancel")).json())


def delete(job_id: str) -> Flow[None]:
    yield Call(method="DELETE", path=f"/v1/jobs/{job_id}")


def refusal(answer: httpx.Response) -> RequestRefused:
    """The problem in an answer that has been read."""
    retry = answer.headers.get("Retry-After", "")
    retry_s = float(retry) if retry.isdigit() else None
    try:
        problem = answer.json()
        return RequestRefused(answer.status_code, str(problem["code"]), str(problem["detail"]), retry_s)
    except (ValueError, KeyError, TypeError):
        sentence = f"The answer was {answer.status_code} {answer.reason_phrase}: is this a Cleave server?"
        return RequestRefused(answer.status_code, "not_understood", sentence, retry_s)
