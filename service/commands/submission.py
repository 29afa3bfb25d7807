"""The submission of one file to a server: its job and its results."""

import hashlib
import json
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from cleave.client import Client
from cleave.client.documents import Job
from cleave.client.errors import ClientError, JobEnded, RequestRefused
from segcore.io import neighbours_of
from service.commands.console import ProgressBoard
from service.commands.server_results import RESULTS, save_result

_WAIT_S = 1.0  # for which a request waits for the end of a job: the time between two updates of a progress bar


@dataclass(frozen=True, slots=True)
class Submission:
    """A file, and what is requested of the server for it."""

    path: Path
    name: str  # of its results, without an extension
    parameters: dict[str, object]
    unit: str | None  # of the coordinates; None: as the file has it
    up: str | None
    segments: int | None
    granularity: float | None
    results: Sequence[str]  # keys of RESULTS
    folder: Path
    again: bool  # compute and save the results even if they exist
    open_parts: bool = False  # do not close the parts of 3MF and ZIP files at their cuts

    def missing(self) -> dict[str, Path]:
        """Return the results to save and their files."""
        files = {result: self.folder / f"{self.name}.{RESULTS[result].extension}" for result in self.results}
        return {result: file for result, file in files.items() if self.again or not file.exists()}

    def level(self) -> dict[str, object]:
        return {"segments": self.segments, "granularity": self.granularity}

    def idempotency_key(self, companions: Mapping[str, Path]) -> str:
        """Return a key that is derived from the parameters and the files."""
        digest = hashlib.sha256(json.dumps(sorted(self.parameters.items())).encode())
        for name, path in [("", self.path), *sorted(companions.items())]:
            digest.update(name.encode("utf-8", "surrogateescape"))
            with path.open("rb") as file:
                digest.update(hashlib.file_digest(file, "sha256").digest())
        digest.update(self.path.suffix.lower().encode())
        digest.update("".join(f"&{said}" for said in (self.unit, self.up) if said).encode())
        return f"cleave-submit-{digest.hexdigest()}"


def submit_file(client: Client, submission: Submission, board: ProgressBoard, stopping: threading.Event) -> str | None:
    """Save the missing results of a file; return a sentence if that failed."""
    missing, label = submission.missing(), submission.path.name
    if stopping.is_set() or not missing:
        board.finish(label, "done before")
        return None
    try:
        job = _finished_job(client, submission, board, stopping)
        for result, target in missing.items():
            save_result(client, job.id, result, target, submission.level(), submission.open_parts)
    except ClientError as error:
        board.finish(label, str(error))
        return f"{label}: {error}"
    board.finish(label, "; ".join([_level_name(job, submission), *job.document.get("notes", [])]))
    return None


def _finished_job(client: Client, submission: Submission, board: ProgressBoard, stopping: threading.Event) -> Job:
    """Submit a file and wait for its job; raise JobEnded if it does not succeed."""
    label = submission.path.name
    board.show(label, "upload", 0.0)
    job = _submitted_job(client, submission)
    while not job.has_ended:
        board.show(label, job.stage or job.status, job.progress)
        if stopping.is_set():
            raise JobEnded(job)
        job = client.job(job.id, wait_s=_WAIT_S)
    if job.status != "succeeded":
        raise JobEnded(job)
    return job


def _submitted_job(client: Client, submission: Submission) -> Job:
    companions = neighbours_of(submission.path)
    key = None if submission.again else submission.idempotency_key(companions)
    options: dict[str, Any] = {"parameters": submission.parameters, "unit": submission.unit, "up": submission.up}
    submit = partial(client.submit, submission.path, companions=companions, **options)
    try:
        return submit(idempotency_key=key, recompute=submission.again)
    except RequestRefused as refusal:
        if refusal.code != "idempotency_key_spent":
            raise
        return submit()  # the first job was deleted


def _level_name(job: Job, submission: Submission) -> str:
    if submission.granularity is not None:
        return f"granularity {submission.granularity:g}"
    return f"{submission.segments or job.automatic_segments} segments"
