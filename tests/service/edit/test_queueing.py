"""Edits that take longer than a request waits: stored, enqueued, and ended by a worker."""

from collections.abc import Callable
from typing import Any

import httpx
import pytest
from redis import Redis

from cleave.settings import Settings
from helpers.api import problem
from helpers.edits.guide import MarksOnly
from helpers.edits.program import SLOW
from helpers.edits.requests import edit, labels
from worker.edits import perform
from worker.jobs.queue.connection import connect
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.store import JobStore

SLOW_EDIT: dict[str, Any] = {"base": 1, "operations": [{"op": "part", "inside": [SLOW]}]}


@pytest.fixture
def run_edit(edit_store: JobStore, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Return a function that runs the edit at a path, as a worker does, with the stand-in for a Guide."""
    monkeypatch.setattr(perform, "guide_of", lambda result: MarksOnly(len(result.mesh.faces)))
    return lambda path: perform.perform_edit(edit_store, path.rpartition("/")[2])


@pytest.fixture
def waiting_queue(edit_settings: Settings) -> JobQueue:
    with Redis.from_url(str(edit_settings.redis_url)) as connection:
        connection.flushall()
    return JobQueue(connect(str(edit_settings.redis_url)))


def test_a_slow_edit_waits_in_the_queue_and_is_sent_again_without_harm(
    api: httpx.Client, job: str, run_edit: Callable[[str], None], waiting_queue: JobQueue
) -> None:
    edit(api, job, 0, {"op": "part", "inside": [3]})
    headers = {"Idempotency-Key": "slow"}
    accepted = api.post(f"{job}/edits", json=SLOW_EDIT, headers=headers)
    assert accepted.status_code == 202, accepted.text
    path = accepted.headers["Location"]
    assert accepted.json()["status"] == "queued"
    assert api.post(f"{job}/edits", json=SLOW_EDIT, headers=headers).headers["Location"] == path
    other = {"base": 1, "operations": [{"op": "lock", "part": 0}]}
    problem(api.post(f"{job}/edits", json=other, headers=headers), 422, "idempotency_key_reused")
    assert waiting_queue.activity(path.rpartition("/")[2]).position == 1
    assert api.get(path, params={"wait": 0.2}).json()["ended_at"] is None
    run_edit(path)
    ended = api.get(path, params={"wait": 5}).json()
    assert (ended["status"], ended["revision"]["number"], ended["error"]) == ("succeeded", 2, None)
    assert ended["revision"]["made_by"] == "anna"
    assert labels(api, job, revision=2)[SLOW] == max(labels(api, job, revision=2))
    again = api.post(f"{job}/edits", json=SLOW_EDIT, headers=headers)
    assert (again.status_code, again.json()["revision"]) == (201, ended["revision"])
    run_edit(path)
    assert api.get(f"{job}/revisions").json()["newest"] == 2


def test_an_edit_that_waited_too_long_is_never_stored_over_a_newer_one(
    api: httpx.Client, job: str, run_edit: Callable[[str], None]
) -> None:
    edit(api, job, 0, {"op": "part", "inside": [3]})
    path = api.post(f"{job}/edits", json=SLOW_EDIT).headers["Location"]
    edit(api, job, 1, {"op": "name", "part": 0, "name": "body"})
    run_edit(path)
    ended = api.get(path).json()
    assert (ended["status"], ended["error"]["code"]) == ("failed", "revision_conflict")
    assert api.get(f"{job}/revisions").json()["newest"] == 2


def test_an_edit_that_cannot_be_applied_fails_with_the_reason(
    api: httpx.Client, job: str, run_edit: Callable[[str], None]
) -> None:
    edit(api, job, 0, {"op": "part", "inside": [3]})
    body = {"base": 1, "operations": [*SLOW_EDIT["operations"], {"op": "lock", "part": 999}]}
    path = api.post(f"{job}/edits", json=body).headers["Location"]
    run_edit(path)
    assert api.get(path).json()["error"]["code"] == "invalid_parameters"


def test_other_ids_are_no_edits(api: httpx.Client, job: str) -> None:
    problem(api.get(f"{job}/edits/{'0' * 32}"), 404, "edit_not_found")
    problem(api.get(f"{job}/edits/x"), 404, "edit_not_found")
