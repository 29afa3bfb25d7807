"""The store, wherever it is: accepted whole or not at all, finished once, deleted for good."""

import hashlib
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from helpers.jobs import accepted
from worker.jobs.job import Canceled, Failed, Job, Succeeded, new_job_id, now
from worker.jobs.store.acceptance import JobExists
from worker.jobs.store.index import complemented
from worker.jobs.store.installation_secret import InstallationSecret
from worker.jobs.store.layout import entry_name
from worker.jobs.store.opening import open_folder
from worker.jobs.store.outbox import Delivery
from worker.jobs.store.spool import Spool
from worker.jobs.store.store import JobStore, UnknownJob


def keys(store: JobStore) -> list[str]:
    """Everything that is in a store."""
    folders = ("batches", "computed", "doomed", "gone", "index", "jobs", "outbox", "pending", "probe")
    return [one.key for folder in folders for one in store.objects.list_below(folder)]


def reopened(store: JobStore, tmp_path: Path) -> JobStore:
    """The store as another process sees it."""
    return JobStore(store.objects, Spool(tmp_path / "another"))


def succeeded() -> Succeeded:
    return Succeeded(finished_at=now(), faces=4, vertices=4, max_segments=3, automatic_segments=2)


def owned(store: JobStore, owner: str | None) -> Job:
    with store.spool.begin_upload() as upload:
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


def test_an_accepted_job_is_read_back_as_it_was_written(placed: JobStore) -> None:
    job = accepted(placed, b"mesh bytes", max_segments=7)
    assert placed.records.job(job.id) == job
    with placed.open_mesh(job.id) as mesh:
        assert mesh.read() == b"mesh bytes"
        mesh.seek(5)
        assert mesh.read() == b"bytes"
    assert list(placed.pending.all()) == [job.id]
    assert job.sha256 == hashlib.sha256(b"mesh bytes").hexdigest()


def test_an_upload_that_breaks_off_leaves_nothing(placed: JobStore, tmp_path: Path) -> None:
    with placed.spool.begin_upload() as upload:
        upload.write(b"half of a mesh")
    assert list((tmp_path / "data" / "incoming").iterdir()) == []
    assert keys(placed) == []


def test_the_first_outcome_stands(placed: JobStore) -> None:
    job = accepted(placed, b"mesh")
    first = Canceled(finished_at=now())
    assert not placed.records.has_ended(job.id)
    assert placed.finish(job.id, first) == first
    assert placed.finish(job.id, succeeded()) == first
    assert placed.records.outcome(job.id) == first
    assert placed.records.has_ended(job.id)
    assert placed.pending.all() == {}


def test_of_many_writers_at_once_one_gives_the_outcome(placed: JobStore) -> None:
    job = accepted(placed, b"mesh")
    outcomes = [Failed(finished_at=now(), code=f"writer_{n}", message="") for n in range(16)]
    standing: list[object] = []
    threads = [
        threading.Thread(target=lambda outcome=outcome: standing.append(placed.finish(job.id, outcome)))
        for outcome in outcomes
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(standing) == 16
    assert {repr(outcome) for outcome in standing} == {repr(placed.records.outcome(job.id))}


def test_of_many_submissions_of_one_id_one_is_accepted_with_its_own_mesh(placed: JobStore) -> None:
    job_id, taken, refused = new_job_id(), [], []

    def submit(mesh: bytes) -> None:
        with placed.spool.begin_upload() as upload:
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
                placed.accept(job, upload)
                taken.append(job)
            except JobExists:
                refused.append(job)

    threads = [threading.Thread(target=submit, args=(f"mesh {number}".encode(),)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert (len(taken), len(refused)) == (1, 7)
    assert placed.records.job(job_id) == taken[0]
    with placed.open_mesh(job_id) as mesh:
        assert hashlib.sha256(mesh.read()).hexdigest() == taken[0].sha256
    assert placed.page(None, None, 10).jobs == taken
    assert list(placed.pending.all()) == [job_id]
    assert len([key for key in keys(placed) if "/mesh" in key]) == 1


def test_every_kind_of_outcome_is_read_back(placed: JobStore) -> None:
    for outcome in (succeeded(), Canceled(finished_at=now()), Failed(finished_at=now(), code="c", message="m")):
        job = accepted(placed, b"mesh")
        placed.finish(job.id, outcome)
        assert placed.records.outcome(job.id) == outcome


def test_attempts_are_counted_until_they_are_withdrawn(placed: JobStore) -> None:
    job = accepted(placed, b"mesh")
    first = placed.begin_attempt(job.id, "worker-1")
    placed.records.end_attempt(job.id, first, "worker_lost")
    second = placed.begin_attempt(job.id, "worker-2")
    assert [attempt.number for attempt in placed.records.attempts(job.id)] == [1, 2]
    assert [attempt.cause for attempt in placed.records.attempts(job.id)] == ["worker_lost", None]
    assert placed.records.states([job.id])[job.id].attempts == placed.records.attempts(job.id)
    placed.records.withdraw_attempt(job.id, second)
    assert [attempt.worker for attempt in placed.records.attempts(job.id)] == ["worker-1"]


def test_a_result_is_read_back_by_every_process(placed: JobStore, tmp_path: Path) -> None:
    job = accepted(placed, b"mesh")
    for _ in range(2):
        placed.results.write(job.id, lambda target: target.write(b"result"))
    for store in (placed, placed, reopened(placed, tmp_path)):
        with store.results.open(job.id) as result:
            assert result.read() == b"result"


def test_a_new_attempt_clears_what_a_killed_one_was_writing(placed: JobStore, tmp_path: Path) -> None:
    job = accepted(placed, b"mesh")
    torn = tmp_path / "data" / "incoming" / f"{job.id}-0123.result"
    torn.write_bytes(b"half of a result")
    placed.begin_attempt(job.id, "worker")
    assert not torn.exists()


def test_a_deleted_job_is_gone_and_cannot_be_finished(placed: JobStore) -> None:
    job = accepted(placed, b"mesh")
    attempt = placed.begin_attempt(job.id, "worker")
    placed.results.write(job.id, lambda target: target.write(b"result"))
    placed.delete(job.id)
    assert placed.records.job(job.id) is None
    for forbidden in (
        lambda: placed.finish(job.id, succeeded()),
        lambda: placed.begin_attempt(job.id, "worker"),
        lambda: placed.records.end_attempt(job.id, attempt, "worker_lost"),
        lambda: placed.results.write(job.id, lambda target: target.write(b"result")),
        lambda: placed.results.open(job.id),
        lambda: placed.delete(job.id),
    ):
        with pytest.raises(UnknownJob):
            forbidden()
    assert keys(placed) == [f"gone/{job.id}"]


@pytest.mark.parametrize("name", ["../../etc/passwd", "", ".", "A" * 32, "0" * 31, "0" * 32 + "\n", "é" * 32])
def test_what_is_no_job_id_is_never_a_key(store: JobStore, name: str) -> None:
    assert store.records.job(name) is None
    with pytest.raises(ValueError, match="Not the id of a job"):
        store.open_mesh(name)


def test_a_marker_without_a_job_is_no_job(placed: JobStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    job = accepted(placed, b"mesh")
    placed.objects.delete(f"jobs/{job.id}/job.json")
    assert reopened(placed, tmp_path).pending.all() == {}
    assert any(job.id in key for key in keys(placed))  # it may be on its way in
    monkeypatch.setattr("worker.jobs.store.pending._GRACE_S", -10.0)
    assert reopened(placed, tmp_path).pending.all() == {}
    assert [key for key in keys(placed) if key.startswith(("pending", "jobs"))] == []


def test_a_crash_between_the_manifest_and_its_marker_heals(placed: JobStore, tmp_path: Path) -> None:
    job = accepted(placed, b"mesh")
    (marker,) = placed.objects.list_below("pending")
    placed.finish(job.id, succeeded())
    placed.objects.put(marker.key, b"")
    assert reopened(placed, tmp_path).pending.all() == {}
    assert placed.objects.list_below("pending") == []


def test_unfinished_jobs_come_oldest_first(placed: JobStore) -> None:
    jobs = [owned(placed, owner) for owner in ("b", None, "a", "b")]
    assert list(placed.pending.all()) == [job.id for job in jobs]
    assert placed.pending.of("b") == [jobs[0].id, jobs[3].id]
    assert placed.pending.count("b") == (4, 2)


def test_jobs_are_paged_newest_first_without_a_gap_or_a_repetition(placed: JobStore) -> None:
    jobs = [accepted(placed, b"mesh") for _ in range(7)]
    found: list[str] = []
    cursor = None
    while True:
        page = placed.page(None, cursor, 3)
        found += [job.id for job in page.jobs]
        cursor = page.next_cursor
        if cursor is None:
            break
    assert found == [job.id for job in reversed(jobs)]


def test_owners_see_their_own_jobs_alone(placed: JobStore) -> None:
    mine, theirs, nobodys = (owned(placed, owner) for owner in ("me", "them", None))
    for job in (mine, theirs, nobodys):
        assert placed.page(job.owner, None, 10).jobs == [job]
        assert placed.pending.of(job.owner) == [job.id]
    assert placed.pending.all() == {mine.id: "me", theirs.id: "them", nobodys.id: None}
    placed.finish(mine.id, Canceled(finished_at=now()))
    assert placed.pending.of("me") == []
    assert placed.page("me", None, 10).jobs == [mine]


def test_what_was_computed_is_found_by_its_owner_alone(placed: JobStore) -> None:
    job = owned(placed, "me")
    assert placed.computed_before(job) is None
    placed.finish(job.id, succeeded())
    assert placed.computed_before(replace(job, id=new_job_id())) == job
    assert placed.computed_before(replace(job, owner="them")) is None


def test_a_second_job_of_the_same_id_leaves_the_first_as_it_is(placed: JobStore) -> None:
    first = accepted(placed, b"mesh")
    second = replace(first, created_at=now(), size_bytes=12, webhook_url="https://example.com/")
    with placed.spool.begin_upload() as upload, pytest.raises(JobExists):
        placed.accept(second, upload)
    assert placed.records.job(first.id) == first
    assert placed.page(None, None, 10).jobs == [first]
    assert placed.outbox.deliveries() == {}
    with placed.open_mesh(first.id) as mesh:
        assert mesh.read() == b"mesh"


def test_a_deletion_is_known_to_its_owner_until_it_is_forgotten(placed: JobStore) -> None:
    job = owned(placed, "me")
    placed.delete(job.id)
    assert placed.deletions.was_deleted(job.id, "me")
    assert not placed.deletions.was_deleted(job.id, None)
    placed.deletions.forget(3600.0)
    assert placed.deletions.was_deleted(job.id, "me")
    placed.deletions.forget(-10.0)
    assert not placed.deletions.was_deleted(job.id, "me")


def test_letters_stay_until_they_are_delivered(placed: JobStore) -> None:
    job_id, other = new_job_id(), new_job_id()
    placed.outbox.put(job_id, Delivery())
    placed.outbox.put(job_id, Delivery(failures=2, due_at=5.0))
    placed.outbox.put(other, Delivery())
    assert placed.outbox.deliveries(except_for={other}) == {job_id: Delivery(failures=2, due_at=5.0)}
    placed.outbox.remove(job_id)
    assert placed.outbox.job_ids() == {other}


def test_every_process_derives_the_same_secrets(placed: JobStore) -> None:
    secrets = [InstallationSecret(placed.objects) for _ in range(2)]
    assert secrets[0].derive("a", "b") == secrets[1].derive("a", "b") != secrets[0].derive("ab")


def test_a_store_that_can_be_written_keeps_no_probe(placed: JobStore) -> None:
    for _ in range(2):
        placed.check_writable()
    assert keys(placed) == []


def test_a_data_folder_of_an_earlier_version_goes_on_working(tmp_path: Path) -> None:
    store = open_folder(tmp_path / "data")
    job, ended = owned(store, "me"), owned(store, "me")
    store.finish(ended.id, succeeded())
    folder = tmp_path / "data"
    for one in (job, ended):  # as they were named
        (folder / "jobs" / one.id / f"mesh-{one.sha256}").rename(folder / "jobs" / one.id / "mesh")
        entry = folder / "index" / "me" / complemented(entry_name(one))
        entry.rename(entry.with_name(entry_name(one)))
    (folder / "pending" / f"{entry_name(job)}.me").rename(folder / "pending" / f"{job.id}.me")
    store = open_folder(tmp_path / "data")
    assert store.pending.all() == {job.id: "me"}
    assert store.page("me", None, 10).jobs == [ended, job]
    with store.open_mesh(job.id) as mesh:
        assert mesh.read() == b""
    store.finish(job.id, succeeded())
    assert store.pending.all() == {}
