"""The store: accepted whole or not at all, finished once, and never a torn file under a final name."""

import hashlib
import os
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from support import accepted
from worker.durable import create_file, replace_file
from worker.jobs import Canceled, Failed, Job, Succeeded, new_job_id, now
from worker.outbox import Outbox
from worker.store import JobExists, JobStore, UnknownJob


def files_below(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def succeeded() -> Succeeded:
    return Succeeded(finished_at=now(), faces=4, vertices=4, max_segments=3, automatic_segments=2)


def test_an_accepted_job_is_read_back_as_it_was_written(store: JobStore) -> None:
    job = accepted(store, b"mesh bytes", max_segments=7)
    assert store.job(job.id) == job
    with store.open_mesh(job.id) as mesh:
        assert mesh.read() == b"mesh bytes"
    assert list(store.unfinished()) == [job.id]
    assert job.sha256 == hashlib.sha256(b"mesh bytes").hexdigest()


def test_an_upload_that_breaks_off_leaves_nothing(store: JobStore, tmp_path: Path) -> None:
    with store.begin_upload() as upload:
        upload.write(b"half of a mesh")
    assert files_below(tmp_path) == []
    assert list((tmp_path / "data" / "incoming").iterdir()) == []


def test_an_upload_whose_process_died_is_removed_when_nobody_touches_it(store: JobStore, tmp_path: Path) -> None:
    orphan = store.begin_upload()
    orphan.write(b"half of a mesh")
    orphan.make_durable()
    store.remove_abandoned_uploads(untouched_s=3600)
    assert files_below(tmp_path) != []
    for path in (orphan.folder, orphan.folder / "mesh"):
        os.utime(path, (0, 0))
    store.remove_abandoned_uploads(untouched_s=3600)
    assert files_below(tmp_path) == []


def test_the_first_outcome_stands(store: JobStore) -> None:
    job = accepted(store, b"mesh")
    first = Canceled(finished_at=now())
    assert store.finish(job.id, first) == first
    assert store.finish(job.id, succeeded()) == first
    assert store.outcome(job.id) == first
    assert store.unfinished() == {}


def test_of_many_writers_at_once_one_gives_the_outcome(store: JobStore) -> None:
    job = accepted(store, b"mesh")
    outcomes = [Failed(finished_at=now(), code=f"writer_{n}", message="") for n in range(16)]
    standing: list[object] = []
    threads = [
        threading.Thread(target=lambda outcome=outcome: standing.append(store.finish(job.id, outcome)))
        for outcome in outcomes
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({repr(outcome) for outcome in standing}) == 1
    assert standing[0] == store.outcome(job.id)


def test_every_kind_of_outcome_is_read_back(store: JobStore) -> None:
    for outcome in (succeeded(), Canceled(finished_at=now()), Failed(finished_at=now(), code="c", message="m")):
        job = accepted(store, b"mesh")
        store.finish(job.id, outcome)
        assert store.outcome(job.id) == outcome


def test_attempts_are_counted_until_they_are_withdrawn(store: JobStore) -> None:
    job = accepted(store, b"mesh")
    first = store.begin_attempt(job.id, "worker-1")
    store.end_attempt(job.id, first, "worker_lost")
    second = store.begin_attempt(job.id, "worker-2")
    assert [attempt.number for attempt in store.attempts(job.id)] == [1, 2]
    assert [attempt.cause for attempt in store.attempts(job.id)] == ["worker_lost", None]
    store.withdraw_attempt(job.id, second)
    assert [attempt.worker for attempt in store.attempts(job.id)] == ["worker-1"]


def test_a_new_attempt_clears_what_a_killed_one_was_writing(store: JobStore, tmp_path: Path) -> None:
    job = accepted(store, b"mesh")
    torn = tmp_path / "data" / "jobs" / job.id / ".result.cleave.0123.tmp"
    torn.write_bytes(b"half of a result")
    store.begin_attempt(job.id, "worker")
    assert not torn.exists()


def test_a_deleted_job_is_gone_and_cannot_be_finished(store: JobStore, tmp_path: Path) -> None:
    job = accepted(store, b"mesh")
    attempt = store.begin_attempt(job.id, "worker")
    store.delete(job.id)
    assert store.job(job.id) is None
    assert files_below(tmp_path) == [f"data/gone/{job.id}"]
    for forbidden in (
        lambda: store.finish(job.id, succeeded()),
        lambda: store.begin_attempt(job.id, "worker"),
        lambda: store.end_attempt(job.id, attempt, "worker_lost"),
        lambda: store.open_result(job.id),
        lambda: store.delete(job.id),
    ):
        with pytest.raises(UnknownJob):
            forbidden()


@pytest.mark.parametrize("name", ["../../etc/passwd", "", ".", "A" * 32, "0" * 31, "0" * 32 + "\n", "é" * 32])
def test_what_is_no_job_id_is_never_a_path(store: JobStore, name: str) -> None:
    assert store.job(name) is None
    with pytest.raises(ValueError, match="Not the id of a job"):
        store.open_mesh(name)


def test_a_marker_without_a_job_is_no_job(store: JobStore, tmp_path: Path) -> None:
    marker = tmp_path / "data" / "pending" / new_job_id()
    marker.touch()
    assert store.unfinished() == {}
    assert marker.exists()  # the job may be on its way in
    os.utime(marker, (0, 0))
    assert store.unfinished() == {}
    assert not marker.exists()


def test_a_crash_between_the_manifest_and_its_marker_heals(store: JobStore, tmp_path: Path) -> None:
    job = accepted(store, b"mesh")
    store.finish(job.id, succeeded())
    (tmp_path / "data" / "pending" / job.id).touch()
    assert store.unfinished() == {}
    assert list((tmp_path / "data" / "pending").iterdir()) == []


def test_unfinished_jobs_come_oldest_first(store: JobStore, tmp_path: Path) -> None:
    jobs = [accepted(store, b"mesh") for _ in range(3)]
    for age, job in enumerate(jobs):
        os.utime(tmp_path / "data" / "pending" / job.id, (1000 - age, 1000 - age))
    assert list(store.unfinished()) == [job.id for job in reversed(jobs)]


def test_a_write_that_fails_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "file"
    replace_file(path, lambda target: target.write(b"old"))

    def fail(_: object) -> None:
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space"):
        replace_file(path, fail)
    assert path.read_bytes() == b"old"
    assert files_below(tmp_path) == ["file"]


def test_a_file_is_created_once(tmp_path: Path) -> None:
    assert create_file(tmp_path / "file", b"first")
    assert not create_file(tmp_path / "file", b"second")
    assert (tmp_path / "file").read_bytes() == b"first"
    assert files_below(tmp_path) == ["file"]


def test_jobs_are_paged_newest_first_without_a_gap_or_a_repetition(store: JobStore) -> None:
    jobs = [accepted(store, b"mesh") for _ in range(7)]
    found: list[str] = []
    cursor = None
    while True:
        page = store.page(None, cursor, 3)
        found += [job.id for job in page.jobs]
        cursor = page.next_cursor
        if cursor is None:
            break
    assert found == [job.id for job in reversed(jobs)]


def test_owners_see_their_own_jobs_alone(store: JobStore) -> None:
    mine, theirs, nobodys = (owned(store, owner) for owner in ("me", "them", None))
    for job in (mine, theirs, nobodys):
        assert store.page(job.owner, None, 10).jobs == [job]
        assert store.unfinished_of(job.owner) == [job.id]
    assert store.unfinished() == {mine.id: "me", theirs.id: "them", nobodys.id: None}
    store.finish(mine.id, Canceled(finished_at=now()))
    assert store.unfinished_of("me") == []
    assert store.page("me", None, 10).jobs == [mine]


def test_a_second_job_of_the_same_id_leaves_the_first_as_it_is(store: JobStore, tmp_path: Path) -> None:
    first = accepted(store, b"mesh")
    second = replace(first, created_at=now(), size_bytes=12, webhook_url="https://example.com/")
    with store.begin_upload() as upload, pytest.raises(JobExists):
        store.accept(second, upload)
    assert store.job(first.id) == first
    assert store.page(None, None, 10).jobs == [first]
    assert Outbox(tmp_path / "data").letters() == {}
    with store.open_mesh(first.id) as mesh:
        assert mesh.read() == b"mesh"


def test_a_deletion_is_known_to_its_owner_until_it_is_forgotten(store: JobStore) -> None:
    job = owned(store, "me")
    store.delete(job.id)
    assert store.was_deleted(job.id, "me")
    assert not store.was_deleted(job.id, None)
    store.forget_deleted(3600.0)
    assert store.was_deleted(job.id, "me")
    store.forget_deleted(-1.0)
    assert not store.was_deleted(job.id, "me")


def owned(store: JobStore, owner: str | None) -> Job:
    with store.begin_upload() as upload:
        job = Job(
            id=new_job_id(),
            sha256=upload.sha256,
            size_bytes=0,
            mesh_format=None,
            parameters={},
            created_at=now(),
            owner=owner,
        )
        store.accept(job, upload)
    return job
