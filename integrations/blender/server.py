"""The steps of a job on a Cleave server."""

import json
import urllib.parse
import urllib.request
import uuid
from dataclasses import dataclass
from typing import Any

import numpy as np

from .arrays import IntArray
from .errors import CleaveError
from .levels import Levels, levels_from
from .web import RefusedError, send, server_url
from .work import Watch

_POLL_S = 2.0  # so that a cancellation is noticed
_ANSWER_S = 60.0  # for a response, without the time of uploads


@dataclass(frozen=True, slots=True)
class Job:
    """A job that has succeeded."""

    id: str
    levels: Levels


@dataclass(frozen=True, slots=True, eq=False)
class Revision:
    """The parts of a job as they were corrected."""

    labels: IntArray  # (F,)
    parts: list[tuple[str, str | None]]  # name, which may be empty, and colour #rrggbb


class Server:
    """A Cleave server and the key for it, which may be empty.

    Raises
    ------
    CleaveError
        If the URL is not one.
    """

    def __init__(self, url: str, api_key: str = "") -> None:
        self.url = server_url(url)
        self._headers = {"Authorization": f"Bearer {api_key.strip()}"} if api_key.strip() else {}

    def segment(self, ply: bytes, faces: int, name: str, watch: Watch) -> Job:
        """Send a mesh, a PLY file, and return its job when it has succeeded.

        Raises
        ------
        CleaveError
            If the server cannot be reached, refuses or fails, or at the end of the time.
        CanceledError
            If the work is stopped; then the job is canceled.
        """
        watch.state = f"sending {name}"
        job = str(self._submit(ply, name, watch)["id"])
        try:
            self._wait(job, name, watch)
        except CleaveError as error:
            if not isinstance(error, RefusedError):
                self._cancel(job)
            raise
        watch.state = f"fetching the parts of {name}"
        document = self._json(f"/v1/jobs/{job}/hierarchy", watch)
        finest = self._send(self._request(f"/v1/jobs/{job}/labels?granularity=1&format=npy"), watch)
        return Job(job, levels_from(document, finest, faces))

    def newest_revision(self, job: str, faces: int, watch: Watch) -> Revision:
        """The parts of the newest revision of a job.

        Raises
        ------
        CleaveError
            If there is none, or the server cannot be reached or refuses.
        """
        watch.state = "fetching the corrected parts"
        runs = self._json(f"/v1/jobs/{job}/labels?revision=latest&format=runs", watch)
        if not runs.get("parts"):
            raise CleaveError("The parts were not corrected on the server: open its page, and correct or name them.")
        labels = np.repeat(np.array(runs["values"], dtype=np.int32), runs["lengths"])
        if len(labels) != faces:
            raise CleaveError(f"The server has {len(labels)} faces, but the mesh has {faces}: segment it again.")
        return Revision(labels, [(part["name"], part["color"]) for part in runs["parts"]])

    def _submit(self, ply: bytes, name: str, watch: Watch) -> Any:
        query = urllib.parse.urlencode({"format": "ply", "file_name": f"{name}.ply"})
        request = self._request(f"/v1/jobs?{query}", ply)
        request.add_header("Content-Type", "model/ply")
        request.add_header("Idempotency-Key", str(uuid.uuid4()))
        return _value(self._send(request, watch))

    def _wait(self, job: str, name: str, watch: Watch) -> None:
        while True:
            document = self._json(f"/v1/jobs/{job}?wait={_POLL_S:g}", watch)
            if document["finished_at"] is not None:
                break
            place = document["queue_position"]
            queued = f"{name} waits, place {place}" if place else f"{name} waits"
            watch.state = f"{name}: {document['stage']}" if document["stage"] else queued
        if document["status"] != "succeeded":
            reason = document["error"]["message"] if document["error"] else "the job was canceled on the server."
            raise RefusedError(200, f"{name}: {reason}", None)

    def _cancel(self, job: str) -> None:
        try:
            send(self._request(f"/v1/jobs/{job}/cancel", b""), timeout_s=_POLL_S)
        except CleaveError:
            return  # the server forgets the job by itself; people see why the work ended

    def _json(self, path: str, watch: Watch) -> Any:
        return _value(self._send(self._request(path), watch))

    def _request(self, path: str, body: bytes | None = None) -> urllib.request.Request:
        return urllib.request.Request(self.url + path, data=body, headers=self._headers)

    def _send(self, request: urllib.request.Request, watch: Watch) -> bytes:
        """Send a request, again if the server is busy and says so; errors as of :func:`send` and :class:`Watch`."""
        while True:
            try:
                return send(request, timeout_s=min(_ANSWER_S, watch.check()))
            except RefusedError as refused:
                if refused.retry_after_s is None:
                    raise
                pause_s = refused.retry_after_s
            watch.state = "the server is busy"
            watch.pause(pause_s)


def _value(body: bytes) -> Any:
    try:
        return json.loads(body)
    except ValueError as error:
        raise CleaveError("The answer is no JSON: is the URL that of a Cleave server?") from error
