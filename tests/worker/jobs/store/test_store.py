"""The store, on every storage: jobs are accepted completely or not at all, finished once, and deleted for good."""

import hashlib
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from helpers.jobs import accepted, unfinished
from worker.jobs.job import Canceled, Failed, Job, Succeeded, new_job_id, now
from worker.jobs.store.acceptance import JobExists
from worker.jobs.store.installation_secret import InstallationSecret
from worker.jobs.store.layout import BEING_DELETED, DELETED, ENDED, TIMELINE
from worker.jobs.store.outbox import Delivery
from worker.jobs.store.spool import Spool
from worker.jobs.store.store import JobStore, UnknownJob


def keys(store: JobStore) -> list[str]:
    """Return the keys of all objects in a store."""
    folders = ("batches", "computed", BEING_DELETED, DELETED, ENDED, "jobs", "outbox", "pending", "probe", TIMELINE)
    return [one.key for folder in folders for one in store.objects.list_below(folder)]


def reopened(store: JobStore, tmp_path: Path) -> JobStore:
    """Open the same store again, as another process does."""
    return JobStore(store.objects, Spool(tmp_path / "another"))


def succeeded() -> Succeeded:
    return Succeeded(finished_at=now(), faces=4, vertices=4, max_segments=3, automatic_segments=2)


def test_an_accepted_job_is_read_back_as_it_was_written(any_store: JobStore) -> None:
    job = accepted(any_store, b"mesh bytes", max_segments=7)
    assert any_store.records.job(job.id) == job
    with any_store.open_mesh(job.id) as mesh:
        assert mesh.read() == b"mesh bytes"
        mesh.seek(5)
        assert mesh.read() == b"bytes"
    assert list(unfinished(any_store)) == [job.id]
    assert job.sha256 == hashlib.sha256(b"mesh bytes").hexdigest()


def test_an_upload_that_breaks_off_leaves_nothing(any_store: JobStore, tmp_path: Path) -> None:
    with any_store.spool.begin_upload() as upload:
        upload.write(b"half of a mesh")
    assert list((tmp_path / "data" / "incoming").iterdir()) == []
    assert keys(any_store) == []


def test_the_first_outcome_stands(any_store: JobStore) -> None:
    job = accepted(any_store, b"mesh")
    first = Canceled(finished_at=now())
    assert not any_store.records.has_ended(job.id)
    assert any_store.finish(job.id, first) == first
    assert any_store.finish(job.id, succeeded()) == first
    assert any_store.records.outcome(job.id) == first
    assert any_store.records.has_ended(job.id)
    assert unfinished(any_store) == {}


def test_one_of_many_concurrent_writers_writes_the_outcome(any_store: JobStore) -> None:
    job = accepted(any_store, b"mesh")
    outcomes = [Failed(finished_at=now(), code=f"writer_{n}", message="") for n in range(16)]
    standing: list[object] = []
    threads = [
        threading.Thread(target=lambda outcome=outcome: standing.append(any_store.finish(job.id, outcome)))
        for outcome in outcomes
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(standing) == 16
    assert {repr(outcome) for outcome in standing} == {repr(any_store.records.outcome(job.id))}


def test_one_of_many_concurrent_submissions_of_one_id_is_accepted_with_its_mesh(any_store: JobStore) -> None:
    job_id, won, refused = new_job_id(), [], []

    def submit(mesh: bytes) -> None:
        with any_store.spool.begin_upload() as upload:
            upload.write(mesh)
            job = Job(
                id=job_id,
                sha256=upload.sha256,
                size_bytes=len(mesh),
                mesh_format=None,
                parameters={},
                created_at=now(),
            )
            try:
                any_store.accept(job, upload)
                won.append(job)
            except JobExists:
                refused.append(job)

    threads = [threading.Thread(target=submit, args=(f"mesh {number}".encode(),)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert (len(won), len(refused)) == (1, 7)
    assert any_store.records.job(job_id) == won[0]
    with any_store.open_mesh(job_id) as mesh:
        assert hashlib.sha256(mesh.read()).hexdigest() == won[0].sha256
    assert any_store.page(None, None, 10).jobs == won
    assert list(unfinished(any_store)) == [job_id]
    assert len([key for key in keys(any_store) if "/mesh" in key]) == 1


def test_every_kind_of_outcome_is_read_back(any_store: JobStore) -> None:
    for outcome in (succeeded(), Canceled(finished_at=now()), Failed(finished_at=now(), code="c", message="m")):
        job = accepted(any_store, b"mesh")
        any_store.finish(job.id, outcome)
        assert any_store.records.outcome(job.id) == outcome


def test_attempts_are_counted_until_they_are_withdrawn(any_store: JobStore) -> None:
    job = accepted(any_store, b"mesh")
    first = any_store.begin_attempt(job.id, "worker-1")
    any_store.records.end_attempt(job.id, first, "worker_lost")
    second = any_store.begin_attempt(job.id, "worker-2")
    assert [attempt.number for attempt in any_store.records.attempts(job.id)] == [1, 2]
    assert [attempt.cause for attempt in any_store.records.attempts(job.id)] == ["worker_lost", None]
    assert any_store.records.states([job.id])[job.id].attempts == any_store.records.attempts(job.id)
    any_store.records.withdraw_attempt(job.id, second)
    assert [attempt.worker for attempt in any_store.records.attempts(job.id)] == ["worker-1"]


def test_a_result_is_read_back_by_every_process(any_store: JobStore, tmp_path: Path) -> None:
    job = accepted(any_store, b"mesh")
    for _ in range(2):
        any_store.results.write(job.id, lambda target: target.write(b"result"))
    for store in (any_store, any_store, reopened(any_store, tmp_path)):
        with store.results.open(job.id) as result:
            assert result.read() == b"result"


def test_a_new_attempt_removes_the_incomplete_result_of_a_killed_one(any_store: JobStore, tmp_path: Path) -> None:
    job = accepted(any_store, b"mesh")
    torn = tmp_path / "data" / "incoming" / f"{job.id}-0123.result"
    torn.write_bytes(b"half of a result")
    any_store.begin_attempt(job.id, "worker")
    assert not torn.exists()


def test_a_deleted_job_is_gone_and_cannot_be_changed(any_store: JobStore) -> None:
    job = accepted(any_store, b"mesh")
    attempt = any_store.begin_attempt(job.id, "worker")
    any_store.results.write(job.id, lambda target: target.write(b"result"))
    any_store.delete(job.id)
    assert any_store.records.job(job.id) is None
    for forbidden in (
        lambda: any_store.finish(job.id, succeeded()),
        lambda: any_store.begin_attempt(job.id, "worker"),
        lambda: any_store.records.end_attempt(job.id, attempt, "worker_lost"),
        lambda: any_store.results.write(job.id, lambda target: target.write(b"result")),
        lambda: any_store.results.open(job.id),
        lambda: any_store.delete(job.id),
    ):
        with pytest.raises(UnknownJob):
            forbidden()
    assert keys(any_store) == [f"{DELETED}/{job.id[:3]}/{job.id}"]


@pytest.mark.parametrize("name", ["../../etc/passwd", "", ".", "A" * 32, "0" * 31, "0" * 32 + "\n", "é" * 32])
def test_what_is_no_job_id_is_never_a_key(store: JobStore, name: str) -> None:
    assert store.records.job(name) is None
    with pytest.raises(ValueError, match="Not the id of a job"):
        store.open_mesh(name)


def test_a_marker_without_a_job_is_ignored_and_later_removed(
    any_store: JobStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = accepted(any_store, b"mesh")
    any_store.objects.delete(f"jobs/{job.id}/job.json")
    assert unfinished(reopened(any_store, tmp_path)) == {}
    assert any(job.id in key for key in keys(any_store))  # as the job may still be uploaded
    monkeypatch.setattr("worker.jobs.store.pending._GRACE_S", -10.0)
    assert unfinished(reopened(any_store, tmp_path)) == {}
    assert [key for key in keys(any_store) if key.startswith(("pending", "jobs"))] == []


def test_a_marker_that_was_left_by_a_crash_after_the_manifest_is_removed(any_store: JobStore, tmp_path: Path) -> None:
    job = accepted(any_store, b"mesh")
    (marker,) = any_store.objects.list_below("pending")
    any_store.finish(job.id, succeeded())
    any_store.objects.put(marker.key, b"")
    assert unfinished(reopened(any_store, tmp_path)) == {}
    assert any_store.objects.list_below("pending") == []
    assert [one.id for one in any_store.ended.oldest("", 10)] == [job.id]


def test_unfinished_jobs_come_oldest_first(any_store: JobStore) -> None:
    jobs = [accepted(any_store, b"", owner) for owner in ("b", None, "a", "b")]
    assert list(unfinished(any_store)) == [job.id for job in jobs]
    assert any_store.pending.oldest_of("b", 10) == [jobs[0].id, jobs[3].id]
    assert any_store.pending.count("b") == (4, 2)


def test_pages_list_every_job_once_newest_first(any_store: JobStore) -> None:
    jobs = [accepted(any_store, b"mesh") for _ in range(7)]
    found: list[str] = []
    cursor = None
    while True:
        page = any_store.page(None, cursor, 3)
        found += [job.id for job in page.jobs]
        cursor = page.next_cursor
        if cursor is None:
            break
    assert found == [job.id for job in reversed(jobs)]


def test_owners_see_their_own_jobs_alone(any_store: JobStore) -> None:
    mine, theirs, unowned = (accepted(any_store, b"", owner) for owner in ("me", "them", None))
    for job in (mine, theirs, unowned):
        assert any_store.page(job.owner, None, 10).jobs == [job]
        assert any_store.pending.oldest_of(job.owner, 10) == [job.id]
    assert unfinished(any_store) == {mine.id: "me", theirs.id: "them", unowned.id: None}
    any_store.finish(mine.id, Canceled(finished_at=now()))
    assert any_store.pending.oldest_of("me", 10) == []
    assert any_store.page("me", None, 10).jobs == [mine]


def with_result(store: JobStore, owner: str | None, data: bytes) -> Job:
    job = accepted(store, b"", owner)
    store.results.write(job.id, lambda target: target.write(data))
    store.finish(job.id, succeeded())
    return job


def test_jobs_with_the_same_input_share_a_result_and_each_keeps_it(any_store: JobStore) -> None:
    first = with_result(any_store, "me", b"a result")
    second, third, fourth = (accepted(any_store, b"", "me") for _ in range(3))
    assert any_store.finish_as_before(second)
    assert unfinished(any_store).keys() == {third.id, fourth.id}
    any_store.delete(first.id)
    assert any_store.finish_as_before(third)  # the second job has the result
    any_store.delete(third.id)
    with any_store.results.open(second.id) as result:
        assert result.read() == b"a result"
    any_store.delete(second.id)
    assert not any_store.finish_as_before(fourth)  # the last job that had the result is gone
    any_store.delete(fourth.id)
    assert [key for key in keys(any_store) if not key.startswith(DELETED)] == []


def test_a_shared_result_has_its_own_time_of_its_end(any_store: JobStore) -> None:
    first = with_result(any_store, "me", b"a result")
    second = accepted(any_store, b"", "me")
    assert any_store.finish_as_before(second)
    ends = [any_store.records.outcome(job.id) for job in (first, second)]
    assert ends[0] is not None
    assert ends[1] is not None
    assert ends[0].finished_at < ends[1].finished_at
    assert replace(ends[1], finished_at=ends[0].finished_at) == ends[0]


def test_results_are_shared_by_jobs_of_one_owner_and_equal_input_alone(any_store: JobStore) -> None:
    with_result(any_store, "me", b"a result")
    for other in (accepted(any_store, b"", "them"), accepted(any_store, b"", None)):
        assert not any_store.finish_as_before(other)
    mine = accepted(any_store, b"", "me")
    for changed in (
        replace(mine, unit="inch"),
        replace(mine, up="z"),
        replace(mine, mesh_format="stl"),
        replace(mine, version="0.0.1"),
        replace(mine, parameters={"seed": 1}),
    ):
        assert not any_store.finish_as_before(changed)
    assert any_store.finish_as_before(mine)


def test_failed_and_canceled_jobs_share_nothing(any_store: JobStore) -> None:
    for outcome in (Failed(finished_at=now(), code="invalid_mesh", message="No."), Canceled(finished_at=now())):
        any_store.finish(accepted(any_store, b"", "me").id, outcome)
    assert not any_store.finish_as_before(accepted(any_store, b"", "me"))


def test_a_second_job_of_the_same_id_does_not_change_the_first(any_store: JobStore) -> None:
    first = accepted(any_store, b"mesh")
    second = replace(first, created_at=now(), size_bytes=12, webhook_url="https://example.com/")
    with any_store.spool.begin_upload() as upload, pytest.raises(JobExists):
        any_store.accept(second, upload)
    assert any_store.records.job(first.id) == first
    assert any_store.page(None, None, 10).jobs == [first]
    assert any_store.outbox.job_ids() == set()
    with any_store.open_mesh(first.id) as mesh:
        assert mesh.read() == b"mesh"


def test_a_deletion_is_remembered_for_its_owner_until_it_is_forgotten(any_store: JobStore) -> None:
    job = accepted(any_store, b"", "me")
    any_store.delete(job.id)
    assert any_store.deletions.was_deleted(job.id, "me")
    assert not any_store.deletions.was_deleted(job.id, None)
    any_store.deletions.forget(3600.0)
    assert any_store.deletions.was_deleted(job.id, "me")
    any_store.deletions.forget(-10.0)
    assert not any_store.deletions.was_deleted(job.id, "me")


def test_deliveries_are_kept_until_they_are_removed(any_store: JobStore) -> None:
    job_id, other = new_job_id(), new_job_id()
    any_store.outbox.put(job_id, Delivery())
    any_store.outbox.put(job_id, Delivery(failures=2, due_at=5.0))
    any_store.outbox.put(other, Delivery())
    assert any_store.outbox.deliveries([job_id]) == {job_id: Delivery(failures=2, due_at=5.0)}
    any_store.outbox.remove(job_id)
    assert any_store.outbox.job_ids() == {other}


def test_every_process_derives_the_same_secrets(any_store: JobStore) -> None:
    secrets = [InstallationSecret(any_store.objects) for _ in range(2)]
    assert secrets[0].derive("a", "b") == secrets[1].derive("a", "b") != secrets[0].derive("ab")


def test_a_write_check_removes_its_probe(any_store: JobStore) -> None:
    for _ in range(2):
        any_store.check_writable()
    assert keys(any_store) == []
