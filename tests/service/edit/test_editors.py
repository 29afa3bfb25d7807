"""Edits that need a Guide: in other processes, which may die or take too long without harm."""

import asyncio
import os
import threading
import time
from pathlib import Path

import httpx
import pytest

import segcore
from cleave.settings import Settings
from helpers.api import problem
from helpers.edits.program import DEADLY, LARGE, SLOW
from helpers.edits.requests import edit, labels
from helpers.processes import children_of
from helpers.waiting import wait_until
from segcore import Partition
from segcore.io import decode_partition, encode_partition, read_result
from service.edit import editors
from service.edit.editor_process import EditorFailed, EditorProcess
from service.edit.editors import PROGRAM, Editors
from service.edit.messages import Message
from worker.jobs.store.store import JobStore


def marks(*faces: int) -> dict[str, object]:
    return {"op": "part", "inside": list(faces)}


def test_marks_strokes_and_borders_change_parts(api: httpx.Client, job: str) -> None:
    before = labels(api, job)
    count = max(before) + 1
    found = edit(api, job, 0, marks(0, 5))
    assert found["changed"] == {"starts": [0, 5], "lengths": [1, 1], "labels": [count, count]}
    assert found["revision"]["what"] == "part from marks to a new part"
    border = edit(api, job, 1, {"op": "border", "a": count, "b": before[1], "stroke": [1]}, {"op": "smooth"})
    assert labels(api, job, revision=2)[1] == count
    assert border["segments"] == count + 1
    cut = edit(api, job, 2, {"op": "cut", "part": count, "stroke": [5]})
    assert cut["segments"] == count + 2


def test_a_preview_of_marks_is_answered_from_the_same_guide(api: httpx.Client, job: str) -> None:
    edit(api, job, 0, marks(0))
    answer = api.post(f"{job}/edits/preview", json={"base": 1, "operations": [marks(3)]})
    assert answer.status_code == 200, answer.text
    assert answer.json()["changed"]["starts"] == [3]


def test_a_process_that_dies_costs_one_edit(api: httpx.Client, job: str, caplog: pytest.LogCaptureFixture) -> None:
    edit(api, job, 0, marks(0))
    deadly = {"base": 1, "operations": [marks(DEADLY)]}
    problem(api.post(f"{job}/edits/preview", json=deadly), 503, "preview_too_slow")
    assert "or has died" in caplog.text
    assert edit(api, job, 1, marks(3))["revision"]["number"] == 2


def test_an_edit_that_needs_more_memory_waits_in_the_queue(api: httpx.Client, job: str) -> None:
    edit(api, job, 0, marks(0))
    large = {"base": 1, "operations": [marks(LARGE)]}
    problem(api.post(f"{job}/edits/preview", json=large), 503, "preview_too_slow")
    assert api.post(f"{job}/edits", json=large).status_code == 202


def test_errors_of_the_process_are_those_of_the_edit(api: httpx.Client, job: str) -> None:
    edit(api, job, 0, marks(0), {"op": "lock", "part": 0})
    body = {"base": 1, "operations": [{"op": "cut", "part": 1, "stroke": []}]}
    problem(api.post(f"{job}/edits", json=body), 422, "invalid_parameters")
    body = {"base": 1, "operations": [{"op": "cut", "part": 0, "stroke": [1]}]}
    problem(api.post(f"{job}/edits", json=body), 409, "part_locked")
    body = {"base": 1, "operations": [marks(1), {"op": "restore", "revision": 7}]}
    problem(api.post(f"{job}/edits", json=body), 404, "revision_not_found")


def test_other_requests_are_answered_while_an_edit_takes_long(api: httpx.Client, job: str) -> None:
    edit(api, job, 0, marks(3))
    answers: list[httpx.Response] = []
    body = {"base": 1, "operations": [marks(SLOW)]}
    slow = threading.Thread(target=lambda: answers.append(api.post(f"{job}/edits/preview", json=body)))
    slow.start()
    time.sleep(0.2)
    for _ in range(5):
        assert api.get(job).status_code == 200
    edit(api, job, 1, {"op": "merge", "parts": [0, 1]})
    assert slow.is_alive()
    slow.join()
    problem(answers[0], 503, "preview_too_slow")
    assert edit(api, job, 2, marks(3))["revision"]["number"] == 3


def test_the_process_has_the_guide_of_the_job(edit_settings: Settings, edit_store: JobStore, job: str) -> None:
    job_id = job.rpartition("/")[2]
    with edit_store.results.open(job_id) as file:
        result = read_result(file)
    edit = {"base": 0, "operations": [{"op": "part", "inside": [5], "outside": [200]}]}
    editor = EditorProcess(edit_settings, PROGRAM)
    try:
        before = encode_partition(Partition(result.hierarchy.labels()))
        answer = editor.ask(Message({"job_id": job_id, "edit": edit}, before), 240.0)
    finally:
        editor.stop()
    assert answer.document == {"held": [job_id]}
    after = decode_partition(answer.data)
    found = segcore.Guide(result.mesh, result.hierarchy).part([5], [200])
    assert len(set(after.labels[found].tolist())) == 1
    assert not (after.labels[~found] == after.labels[5]).any()


@pytest.mark.usefixtures("api")
def test_a_process_ends_with_its_service(edit_settings: Settings) -> None:
    editor = EditorProcess(edit_settings, ("-m", "helpers.edits.program"))
    editor.ask(Message({"job_id": "0" * 32, "edit": None}), 60.0)
    (pid,) = (pid for pid in children_of(os.getpid()) if b"edits.program" in _command(pid))
    editor.stop()
    wait_until(lambda: not Path(f"/proc/{pid}").exists())


def test_processes_that_are_stopped_are_not_reported_as_dead_and_are_not_started_again(
    edit_settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    starts = tmp_path / "starts"
    program = f"import sys; open({str(starts)!r}, 'a').write('.'); sys.stdin.read()"  # it does not answer
    monkeypatch.setattr(editors, "PROGRAM", ("-c", program))
    stopped = Editors(edit_settings.model_copy(update={"edit_processes": 1, "edit_timeout_s": 60.0}))

    async def stop_while_two_wait() -> list[Message | BaseException]:
        asked = [stopped.ask(job_id, Message({"job_id": job_id, "edit": {}})) for job_id in "ab"]
        waiting = [asyncio.ensure_future(one) for one in asked]
        while not (starts.exists() and starts.read_text()):
            await asyncio.sleep(0.01)
        stopped.stop()
        return await asyncio.gather(*waiting, return_exceptions=True)

    assert [type(one) for one in asyncio.run(stop_while_two_wait())] == [EditorFailed, asyncio.CancelledError]
    assert starts.read_text() == "."
    assert caplog.messages == []


def _command(pid: int) -> bytes:
    return Path(f"/proc/{pid}/cmdline").read_bytes()
