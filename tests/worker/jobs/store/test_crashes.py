"""Crashes between any two writes: a job is in the old or in the new state afterwards, and leftovers are removed."""

import errno
from collections.abc import Callable
from dataclasses import replace
from datetime import timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.jobs import unfinished
from helpers.storage.failures import FailingObjects, Killed, killed_at_every_write
from segcore import Partition
from worker.jobs.job import Job, Succeeded, new_job_id, now
from worker.jobs.objects.interface import StoreError
from worker.jobs.queued_edit import EditOutcome, QueuedEdit
from worker.jobs.revision import Revision
from worker.jobs.store.acceptance import JobExists
from worker.jobs.store.layout import BEING_DELETED, ENDED, JOBS, TIMELINE
from worker.jobs.store.outbox import Delivery
from worker.jobs.store.spool import Spool
from worker.jobs.store.store import JobStore, UnknownJob


@pytest.fixture
def reopen(any_store: JobStore, tmp_path: Path) -> Callable[..., JobStore]:
    """Opens the store of the test, or one on other storage, as a new process does."""

    def opened(objects: Any = None) -> JobStore:
        return JobStore(objects or any_store.objects, Spool(tmp_path / "data" / "incoming"))

    return opened


@pytest.fixture
def nothing_is_young(monkeypatch: pytest.MonkeyPatch) -> None:
    """Objects without a job are old enough to be removed."""
    monkeypatch.setattr("worker.jobs.store.pending._GRACE_S", -10.0)
    monkeypatch.setattr("worker.jobs.store.pages._GRACE", timedelta(days=-1))


def a_job() -> Job:
    return Job(
        id=new_job_id(),
        sha256="",
        size_bytes=4,
        mesh_format=None,
        parameters={},
        created_at=now(),
        owner="me",
        webhook_url="https://example.com/",
    )


def accept(store: JobStore, job: Job) -> Job:
    with store.spool.begin_upload() as upload:
        upload.write(b"mesh")
        job = replace(job, sha256=upload.sha256)
        store.accept(job, upload)
    return job


def succeeded() -> Succeeded:
    return Succeeded(finished_at=now(), faces=4, vertices=4, max_segments=3, automatic_segments=2)


def all_keys(store: JobStore) -> list[str]:
    folders = ("computed", BEING_DELETED, ENDED, JOBS, "outbox", "pending", TIMELINE)
    return [one.key for folder in folders for one in store.objects.list_below(folder)]


def test_a_job_is_accepted_completely_or_not_at_all(
    any_store: JobStore, reopen: Callable[..., JobStore], nothing_is_young: None
) -> None:
    del nothing_is_young
    job = a_job()
    seen = set()

    def renew() -> None:
        nonlocal job
        job = a_job()

    for _ in killed_at_every_write(any_store.objects, lambda failing: accept(reopen(failing), job), renew):
        store = reopen()
        is_there = store.records.job(job.id) is not None
        seen.add(is_there)
        assert store.pending.oldest_of("me", 10) == [job.id] * is_there
        assert [one.id for one in store.page("me", None, 10).jobs] == [job.id] * is_there
        if is_there:
            with store.open_mesh(job.id) as mesh:
                assert mesh.read() == b"mesh"
            assert store.outbox.delivery(job.id) == Delivery()
            with pytest.raises(JobExists):
                accept(store, job)
            store.delete(job.id)
        store.outbox.remove(job.id)  # as the webhook process does if there is no job
        unfinished(store)
        assert all_keys(reopen()) == []
    assert seen == {True, False}


def test_the_remains_of_a_killed_submission_do_not_prevent_the_next_one(
    any_store: JobStore, reopen: Callable[..., JobStore]
) -> None:
    job = a_job()

    def renew() -> None:
        nonlocal job
        job = a_job()

    for _ in killed_at_every_write(any_store.objects, lambda failing: accept(reopen(failing), job), renew):
        if any_store.records.job(job.id) is None:
            accept(reopen(), job)
        assert reopen().pending.oldest_of("me", 10) == [job.id]
        with reopen().open_mesh(job.id) as mesh:
            assert mesh.read() == b"mesh"
        reopen().delete(job.id)


def test_a_job_is_finished_or_can_be_finished_afterwards(any_store: JobStore, reopen: Callable[..., JobStore]) -> None:
    job, first = a_job(), succeeded()

    def renew() -> None:
        nonlocal job, first
        job, first = accept(any_store, a_job()), succeeded()

    def work(failing: Any) -> None:
        store = reopen(failing)
        store.begin_attempt(job.id, "worker")
        store.results.write(job.id, lambda target: target.write(b"result"))
        store.finish(job.id, first)

    for _ in killed_at_every_write(any_store.objects, work, renew):
        store = reopen()
        outcome = store.records.outcome(job.id)
        assert (job.id in unfinished(store)) == (outcome is None)
        assert [one.id for one in store.ended.oldest("", 1000) if one.id == job.id] == [job.id] * (outcome is not None)
        assert len(store.records.attempts(job.id)) <= 1
        again = succeeded()
        store.begin_attempt(job.id, "another")
        store.results.write(job.id, lambda target: target.write(b"result"))
        assert store.finish(job.id, again) == (outcome or again)
        with store.results.open(job.id) as result:
            assert result.read() == b"result"
        assert job.id not in unfinished(store)
        (ended,) = (one for one in store.ended.oldest("", 1000) if one.id == job.id)
        assert ended.size_bytes == len(b"mesh") + len(b"result")


def test_a_job_is_deleted_for_good_or_still_exists(any_store: JobStore, reopen: Callable[..., JobStore]) -> None:
    job = a_job()

    def renew() -> None:
        nonlocal job
        job = accept(any_store, replace(a_job(), webhook_url=None))
        any_store.results.write(job.id, lambda target: target.write(b"result"))
        any_store.finish(job.id, succeeded())

    for write in killed_at_every_write(any_store.objects, lambda failing: reopen(failing).delete(job.id), renew):
        store = reopen()
        if store.records.job(job.id) is None:
            assert store.deletions.was_deleted(job.id, "me")
            assert store.page("me", None, 10).jobs == []
            with pytest.raises(UnknownJob):
                store.finish(job.id, succeeded())
        elif write == 0 and not store.objects.list_below(BEING_DELETED):
            store.delete(job.id)  # the deletion had not begun
        store.finish_deletions(-10.0)
        assert all_keys(reopen()) == []
        assert store.deletions.was_deleted(job.id, "me")


def test_a_submission_that_fails_on_a_full_disk_is_removed(
    any_store: JobStore, reopen: Callable[..., JobStore], tmp_path: Path
) -> None:
    class FullDisk(FailingObjects):
        """Only deletions work."""

        def __getattr__(self, name: str) -> Any:
            return getattr(self._objects, name) if name == "delete" else super().__getattr__(name)

    for write in range(100):
        job = a_job()
        full = FullDisk(any_store.objects, write, OSError(errno.ENOSPC, "No space left on device"))
        try:
            accept(reopen(full), job)
        except OSError as error:
            assert error.errno == errno.ENOSPC  # noqa: PT017
            assert all_keys(reopen()) == []
            assert list((tmp_path / "data" / "incoming").iterdir()) == []
            continue
        assert reopen().pending.oldest_of("me", 10) == [job.id]
        assert write > 2
        return
    raise AssertionError("the function does not end")


def test_a_lost_response_of_the_store_loses_no_job(any_store: JobStore, reopen: Callable[..., JobStore]) -> None:
    """The record may have been written although no response arrived, so its mesh must not be removed."""
    for write in range(100):
        job = a_job()
        failing = FailingObjects(any_store.objects, write, StoreError("no answer"), is_done=True)
        try:
            accept(reopen(failing), job)
        except StoreError:
            store = reopen()
            if store.records.job(job.id) is not None:
                with store.open_mesh(job.id) as mesh:
                    assert mesh.read() == b"mesh"
                assert job.id in unfinished(store)
            continue
        assert not failing.has_failed or write > 3
        assert any_store.records.has_job(job.id)
        return
    raise AssertionError("the function does not end")


def test_a_killed_edit_has_made_its_revision_completely_or_not_at_all(
    any_store: JobStore, reopen: Callable[..., JobStore]
) -> None:
    job = accept(any_store, a_job())
    any_store.finish(job.id, succeeded())
    parts = Partition(np.array([0, 1, 1], dtype=np.int32))
    seen = set()
    for number, is_done in [(1, False), (1, True), (2, True)]:
        failing = FailingObjects(any_store.objects, 0, Killed(), is_done=is_done)
        revision = Revision(number=number, parent=number - 1, made_at=now(), made_by=None, what="cut", parts=2)
        with pytest.raises(Killed):
            reopen(failing).revisions.add(job.id, revision, parts)
        newest = reopen().revisions.newest(job.id)
        seen.add(newest)
        for made in range(1, newest + 1):
            assert reopen().revisions.partition(job.id, made).labels.tolist() == [0, 1, 1]
    assert seen == {0, 1, 2}


def test_an_edit_in_the_queue_is_accepted_and_ends_once_or_can_be_run_again(
    any_store: JobStore, reopen: Callable[..., JobStore]
) -> None:
    job = accept(any_store, a_job())
    any_store.finish(job.id, succeeded())
    edit = QueuedEdit(
        id=new_job_id(), job_id=job.id, accepted_at=now(), made_by=None, request="r", content=None, edit={"base": 0}
    )
    outcome = EditOutcome(ended_at=now(), revision=1)

    def renew() -> None:
        nonlocal edit
        edit = replace(edit, id=new_job_id())

    def work(failing: Any) -> None:
        store = reopen(failing)
        store.queued_edits.accept(edit)
        store.queued_edits.begin(edit)
        store.queued_edits.end(edit, outcome)

    seen = set()
    for _ in killed_at_every_write(any_store.objects, work, renew):
        edits = reopen().queued_edits
        accepted, ended = edits.find(job.id, edit.id), edits.outcome(job.id, edit.id)
        seen.add((accepted is not None, ended is not None))
        assert accepted in (None, edit)
        if accepted is not None and ended is None:
            assert edits.waiting(edit.id) == edit
            assert edit.id in edits.waiting_ids()
            edits.begin(edit)
            edits.end(edit, outcome)
        elif ended is not None:
            edits.end(edit, replace(outcome, revision=2))
        if accepted is not None:
            assert edits.outcome(job.id, edit.id) == outcome
            assert edits.waiting_ids() == []
    assert seen == {(False, False), (True, False), (True, True)}
    any_store.delete(job.id)
    assert any_store.objects.keys_below(f"jobs/{job.id}") == []
    with pytest.raises(UnknownJob):
        any_store.queued_edits.accept(edit)
    assert any_store.queued_edits.waiting(edit.id) is None
