"""The submission of one file to a server: its job and its results."""

import hashlib
import json
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal, TypeAlias

from cleave.client import Client
from cleave.client.documents import Job
from cleave.client.errors import ClientError, JobEnded, RequestRefused
from segcore.errors import CleaveError
from segcore.io import model_in_folder, neighbours_of
from service.commands.console import ProgressBoard, printable
from service.commands.server_results import RESULTS, save_result
from service.commands.submit_record import SubmitRecord

_WAIT_S = 1.0  # for which a request waits for the end of a job: the time between two updates of a progress bar

Ending: TypeAlias = Literal["made", "kept"]  # the results were made now, or are those of an earlier run


@dataclass(frozen=True, slots=True)
class Submission:
    """A file, and what is requested of the server for it."""

    path: Path  # a mesh file, or a folder with one
    name: str  # of its results, without an extension
    parameters: dict[str, object]
    unit: str | None  # of the coordinates; None: as the file has it
    up: str | None
    segments: int | None
    granularity: float | None
    results: Sequence[str]  # keys of RESULTS
    folder: Path
    again: bool  # compute and save the results even if they are current
    open_parts: bool = False  # do not close the parts of 3MF and ZIP files at their cuts

    def target(self, result: str) -> Path:
        """Return the file of a result."""
        return self.folder / f"{self.name}.{RESULTS[result].extension}"

    def level(self) -> dict[str, object]:
        return {"segments": self.segments, "granularity": self.granularity}

    def input_digest(self, companions: Mapping[str, Path]) -> str:
        """Return a digest of the parameters and the files: of all that the job depends on, except for the server."""
        digest = hashlib.sha256(json.dumps(sorted(self.parameters.items())).encode())
        for name, path in [("", self.path), *sorted(companions.items())]:
            digest.update(name.encode("utf-8", "surrogateescape"))
            with path.open("rb") as file:
                digest.update(hashlib.file_digest(file, "sha256").digest())
        digest.update(self.path.suffix.lower().encode())
        digest.update("".join(f"&{said}" for said in (self.unit, self.up) if said).encode())
        return digest.hexdigest()

    def made_from(self, result: str, input_digest: str, version: str) -> str:
        """Return a digest of all that a result depends on."""
        one = RESULTS[result]
        level = self.level() if one.has_level else {}
        is_open = self.open_parts and one.is_closed
        given = [input_digest, version, result, sorted(level.items()), is_open]
        return hashlib.sha256(json.dumps(given).encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class Session:
    """What the submissions of one run share."""

    client: Client
    board: ProgressBoard
    record: SubmitRecord
    stopping: threading.Event
    version: str  # of the server


def submit_file(session: Session, submission: Submission) -> tuple[Ending | None, str]:
    """Save the results of a file that are not current; return how it ended, None if it failed, and a sentence."""
    label = printable(submission.path.name)
    try:
        ending, text = _submit(session, replace(submission, path=model_in_folder(submission.path)))
    except OSError as error:
        ending, text = None, f"{error.strerror or error}"
    except (ClientError, CleaveError) as error:
        ending, text = None, str(error)
    session.board.finish(label, text)
    return ending, f"{label}: {text}"


def _submit(session: Session, submission: Submission) -> tuple[Ending, str]:
    companions = neighbours_of(submission.path)
    digest = submission.input_digest(companions)
    made_from = {result: submission.made_from(result, digest, session.version) for result in submission.results}
    missing = [
        result
        for result in submission.results
        if submission.again or not session.record.is_current(submission.target(result), made_from[result])
    ]
    if session.stopping.is_set() or not missing:
        return "kept", "done before"
    job = _finished_job(session, submission, companions, digest)
    for result in missing:
        target = submission.target(result)
        save_result(session.client, job.id, result, target, submission.level(), submission.open_parts)
        session.record.add(target, made_from[result])
    return "made", "; ".join([_level_name(job, submission), *job.document.get("notes", [])])


def _finished_job(session: Session, submission: Submission, companions: dict[str, Path], digest: str) -> Job:
    """Submit a file and wait for its job; raise JobEnded if it does not succeed."""
    label = printable(submission.path.name)
    session.board.show(label, "upload", 0.0)
    job = _submitted_job(session, submission, companions, digest)
    while not job.has_ended:
        session.board.show(label, job.stage or job.status, job.progress, job.seconds_left)
        if session.stopping.is_set():
            raise JobEnded(job)
        job = session.client.job(job.id, wait_s=_WAIT_S)
    if job.status != "succeeded":
        session.record.add_failure(digest)
        raise JobEnded(job)
    return job


def _submitted_job(session: Session, submission: Submission, companions: dict[str, Path], digest: str) -> Job:
    """Return the job of an earlier run with the same input, unless that failed; else a new one."""
    options: dict[str, Any] = {"parameters": submission.parameters, "unit": submission.unit, "up": submission.up}
    submit = partial(session.client.submit, submission.path, companions=companions, **options)
    if submission.again:
        return submit(recompute=True)
    try:
        return submit(idempotency_key=f"cleave-submit-{session.version}-{digest}-{session.record.failures(digest)}")
    except RequestRefused as refusal:
        if refusal.code != "idempotency_key_spent":
            raise
        return submit()  # the first job was deleted


def _level_name(job: Job, submission: Submission) -> str:
    if submission.granularity is not None:
        return f"granularity {submission.granularity:g}"
    count = submission.segments or job.automatic_segments
    return f"{count} segment{'s' if count != 1 else ''}"
