"""`cleave submit`: many files to a server, their results into a folder, and no work done twice after a break."""

import hashlib
import json
import sys
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from cleave.client import Client
from cleave.client.documents import Job
from cleave.client.errors import ClientError, JobEnded, RequestRefused
from service.commands.progress_board import ProgressBoard
from service.commands.saved_results import RESULTS

_AT_A_TIME = 4
_POLL_S = 1.0
_RETRIES = 8  # a server that is being restarted is waited for, a minute or so

_OF_ALL_LEVELS = ("json",)


@dataclass(frozen=True, slots=True, kw_only=True)
class SubmitRequest:
    """What the command line asked for."""

    files: Sequence[Path]
    server: str
    api_key: str | None
    segments: int | None
    granularity: float | None  # in place of the number
    parameters: dict[str, object]
    results: Sequence[str]  # keys of RESULTS
    folder: Path
    again: bool  # compute what was computed before


class SomeFailed(Exception):  # noqa: N818
    """Not every file has its results; the message says how many."""


def submit_files(request: SubmitRequest) -> list[str]:
    """Submit files, wait, save their results, and sum up in a few lines.

    A file whose results are there is left alone. A job is named after the content of its file and what is asked of it,
    so a second run goes on with the jobs of the first.

    Raises
    ------
    SomeFailed
        Where a file was refused, its job failed, or the server was lost.
    OSError
        Where a file cannot be read, or a result not be written.
    """
    names = _result_names(request.files)
    for path in request.files:
        path.stat()
    request.folder.mkdir(parents=True, exist_ok=True)
    stopping = threading.Event()
    with (
        ProgressBoard(sys.stderr) as board,
        Client(request.server, request.api_key, retries=_RETRIES) as client,
        ThreadPoolExecutor(_AT_A_TIME) as pool,
    ):
        futures = [
            pool.submit(_one, client, request, path, name, board, stopping)
            for path, name in zip(request.files, names, strict=True)
        ]
        try:
            failures = [future.result() for future in futures]
        except BaseException:
            stopping.set()
            pool.shutdown(cancel_futures=True)
            raise
    failed = [sentence for sentence in failures if sentence]
    done = f"{len(names) - len(failed)} of {len(names)} files have their results in {request.folder}"
    if failed:
        raise SomeFailed(f"{done}; the others: {'; '.join(failed)}")
    return [done]


def _one(
    client: Client, request: SubmitRequest, path: Path, name: str, board: ProgressBoard, stopping: threading.Event
) -> str | None:
    """Bring one file to its results; a sentence where that failed."""
    wanted = {result: request.folder / f"{name}.{RESULTS[result][0]}" for result in request.results}
    missing = {result: target for result, target in wanted.items() if request.again or not target.exists()}
    if stopping.is_set() or not missing:
        board.finish(path.name, "done before")
        return None
    try:
        job = _finished(client, request, path, lambda stage, part: board.show(path.name, stage, part), stopping)
        for result, target in missing.items():
            _save(client, job, result, target, request)
    except ClientError as error:
        board.finish(path.name, str(error))
        return f"{path.name}: {error}"
    board.finish(path.name, _level(job, request))
    return None


def _finished(
    client: Client, request: SubmitRequest, path: Path, show: Callable[[str, float], None], stopping: threading.Event
) -> Job:
    show("upload", 0.0)
    parameters = request.parameters
    key = None if request.again else _key(path, parameters)
    try:
        job = client.submit(path, parameters=parameters, idempotency_key=key, recompute=request.again)
    except RequestRefused as refusal:
        if refusal.code != "idempotency_key_spent":
            raise
        job = client.submit(path, parameters=parameters)  # the job of an earlier run was deleted
    while not job.has_ended:
        show(job.stage or job.status, job.progress)
        if stopping.is_set():
            raise JobEnded(job)
        job = client.job(job.id, wait_s=_POLL_S)
    if job.status != "succeeded":
        raise JobEnded(job)
    return job


def _level(job: Job, request: SubmitRequest) -> str:
    if request.granularity is not None:
        return f"granularity {request.granularity:g}"
    return f"{request.segments or job.automatic_segments} segments"


def _save(client: Client, job: Job, result: str, target: Path, request: SubmitRequest) -> None:
    address, _, query = RESULTS[result][1].partition("?")
    level: dict[str, object] = {"segments": request.segments, "granularity": request.granularity}
    params = {} if result in _OF_ALL_LEVELS else level
    if query:
        name, _, value = query.partition("=")
        params[name] = value
    client.download(job.id, address, target, **params)


def _key(path: Path, parameters: dict[str, object]) -> str:
    digest = hashlib.sha256(json.dumps(sorted(parameters.items())).encode())
    with path.open("rb") as file:
        digest.update(hashlib.file_digest(file, "sha256").digest())
    digest.update(path.suffix.lower().encode())
    return f"cleave-submit-{digest.hexdigest()}"


def _result_names(files: Sequence[Path]) -> list[str]:
    """The stem of every file; where two would overwrite each other, all get their whole names."""
    stems = [path.stem for path in files]
    names = stems if len(set(stems)) == len(stems) else [path.name for path in files]
    if len(set(names)) < len(names):
        raise SomeFailed("Two files have the same name: submit them into different folders.")
    return names
