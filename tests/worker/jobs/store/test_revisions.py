"""Revisions in the store: made once, complete or not at all, and gone with their job."""

import threading
from typing import Any

import numpy as np
import pytest

from helpers.jobs import accepted
from segcore import Part, Partition
from worker.jobs.job import Succeeded, now
from worker.jobs.revision import Revision
from worker.jobs.store.records import UnknownJob
from worker.jobs.store.revisions import RevisionDamaged, RevisionExists, RevisionPage, UnknownRevision
from worker.jobs.store.store import JobStore

PARTS = Partition(np.array([0, 1, 1, 2], dtype=np.int32), (Part("arm"), Part(), Part()))


def revision(number: int, what: str = "merge") -> Revision:
    return Revision(number=number, parent=number - 1, made_at=now(), made_by="me", what=what, parts=3)


def finished(store: JobStore) -> str:
    job = accepted(store, b"mesh")
    store.finish(job.id, Succeeded(finished_at=now(), faces=4, vertices=4, max_segments=3, automatic_segments=2))
    return job.id


def test_a_revision_is_read_as_it_was_written(any_store: JobStore) -> None:
    job_id = finished(any_store)
    assert any_store.revisions.newest(job_id) == 0
    records = [revision(number) for number in range(1, 13)]
    for record in records:
        any_store.revisions.add(job_id, record, PARTS)
    assert any_store.revisions.newest(job_id) == 12
    assert any_store.revisions.page(job_id, None, 3) == RevisionPage(records[:8:-1], 10)
    assert any_store.revisions.page(job_id, 3, 10) == RevisionPage(records[1::-1], None)
    assert any_store.revisions.page(job_id, 3, 2) == RevisionPage(records[1::-1], None)
    assert any_store.revisions.revision(job_id, 7) == records[6]
    read = any_store.revisions.partition(job_id, 7)
    assert (read.labels.tolist(), read.parts) == (PARTS.labels.tolist(), PARTS.parts)
    assert any_store.records.states([job_id])[job_id].revision == 12
    for number in (0, 13, -1, 10**8):
        with pytest.raises(UnknownRevision):
            any_store.revisions.revision(job_id, number)


def test_of_many_writers_of_a_revision_one_has_made_it(any_store: JobStore) -> None:
    job_id = finished(any_store)
    outcomes: list[str] = []
    together = threading.Barrier(4)

    def write(what: str) -> None:
        together.wait()
        try:
            any_store.revisions.add(job_id, revision(1, what), PARTS)
            outcomes.append(what)
        except RevisionExists:
            outcomes.append("")

    threads = [threading.Thread(target=write, args=(str(number),)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    (made,) = filter(None, outcomes)
    assert any_store.revisions.revision(job_id, 1).what == made


def test_damage_is_found(any_store: JobStore) -> None:
    job_id = finished(any_store)
    any_store.revisions.add(job_id, revision(1), PARTS)
    (key,) = any_store.objects.keys_below(f"jobs/{job_id}/revisions")
    whole = any_store.objects.get(key) or b""
    for damaged in (b"", whole[:-1], whole[:70] + b"x" + whole[71:], b"0" * 64 + whole[64:]):
        any_store.objects.put(key, damaged or b" ")
        with pytest.raises(RevisionDamaged):
            any_store.revisions.partition(job_id, 1)


def test_revisions_are_deleted_with_their_job(any_store: JobStore) -> None:
    job_id = finished(any_store)
    any_store.revisions.add(job_id, revision(1), PARTS)
    any_store.delete(job_id)
    assert any_store.objects.keys_below(f"jobs/{job_id}") == []
    with pytest.raises(UnknownJob):
        any_store.revisions.add(job_id, revision(2), PARTS)
    assert any_store.objects.keys_below(f"jobs/{job_id}") == []


def test_a_job_that_is_deleted_during_an_edit_leaves_nothing(any_store: JobStore, monkeypatch: Any) -> None:
    job_id = finished(any_store)
    create = any_store.objects.create

    def delete_then_create(key: str, data: bytes) -> bool:
        if "/revisions/" in key:
            any_store.delete(job_id)
        return create(key, data)

    monkeypatch.setattr(any_store.objects, "create", delete_then_create)
    with pytest.raises(UnknownJob):
        any_store.revisions.add(job_id, revision(1), PARTS)
    assert any_store.objects.keys_below(f"jobs/{job_id}") == []
