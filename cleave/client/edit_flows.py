"""The operations of the client on revisions, as generators like those of :mod:`cleave.client.flows`."""

import io
import json
import secrets
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cleave.client.documents import Edited, Revision, edited_from, revision_from
from cleave.client.errors import RequestRefused
from cleave.client.flows import POLL_S, Call, Flow

_PAGE = 100  # revisions; the server allows up to 200


def revisions(job_id: str) -> Flow[list[Revision]]:
    """Return all revisions, newest first."""
    found: list[Revision] = []
    before: int | None = None
    while True:
        params = {"limit": str(_PAGE)} | ({} if before is None else {"before": str(before)})
        page = (yield Call(method="GET", path=f"/v1/jobs/{job_id}/revisions", params=params)).json()
        found += map(revision_from, page["revisions"])
        before = page["next"]
        if before is None:
            return found


def newest(job_id: str) -> Flow[int]:
    """Return the number of the newest revision, 0 if there is none."""
    page = (yield Call(method="GET", path=f"/v1/jobs/{job_id}/revisions", params={"limit": "1"})).json()
    return int(page["newest"])


def edit(
    job_id: str,
    operations: Sequence[Mapping[str, Any]],
    base: int | None,
    level: Mapping[str, Any] | None,
    is_preview: bool,
) -> Flow[Edited]:
    """Make the next revision, or show what it would be."""
    if base is None:
        base = yield from newest(job_id)
    body = {"base": base, "level": level, "operations": list(operations)}
    response = yield Call(
        method="POST",
        path=f"/v1/jobs/{job_id}/edits" + ("/preview" if is_preview else ""),
        headers={"Content-Type": "application/json", "Idempotency-Key": secrets.token_urlsafe(16)},
        body=[json.dumps(body).encode()],
    )
    if response.status_code == 202:
        return (yield from _ended(job_id, response.headers["Location"]))
    return edited_from(response.json())


def _ended(job_id: str, path: str) -> Flow[Edited]:
    """Wait until an edit in the queue has ended, and return its revision."""
    own_path = path[path.index("/v1/") :]  # without the prefix of a proxy, which the URL of the client has
    while True:
        response = yield Call(method="GET", path=own_path, params={"wait": f"{POLL_S:g}"}, wait_s=POLL_S)
        queued = response.json()
        if queued["error"] is not None:
            raise RequestRefused(409, queued["error"]["code"], queued["error"]["message"])
        if queued["revision"] is not None:
            path = f"/v1/jobs/{job_id}/revisions/{queued['revision']['number']}"
            parts = (yield Call(method="GET", path=path)).json()["parts"]
            return edited_from({"revision": queued["revision"], "parts": parts})


def put_labels(job_id: str, labels: ArrayLike, base: int | None) -> Flow[Edited]:
    """Store labels as the next revision."""
    if base is None:
        base = yield from newest(job_id)
    file = io.BytesIO()
    np.save(file, np.asarray(labels), allow_pickle=False)
    response = yield Call(
        method="PUT",
        path=f"/v1/jobs/{job_id}/labels",
        params={"base": str(base)},
        headers={"Content-Type": "application/x-npy", "Idempotency-Key": secrets.token_urlsafe(16)},
        body=[file.getvalue()],
    )
    return edited_from(response.json())
