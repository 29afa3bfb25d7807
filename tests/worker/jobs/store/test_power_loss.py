"""A crash of the machine: an accepted job and an outcome survive it, and what is left before that is not torn."""

from pathlib import Path

import pytest

from helpers.jobs import unfinished
from helpers.storage.power import Disk
from worker.jobs.job import Job, Succeeded, new_job_id, now
from worker.jobs.objects.local import LocalObjects
from worker.jobs.store.acceptance import JobExists
from worker.jobs.store.layout import RESULT, job_key
from worker.jobs.store.outbox import Delivery
from worker.jobs.store.spool import Spool
from worker.jobs.store.store import JobStore


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "data"
    made.mkdir()
    return made


@pytest.fixture
def store(folder: Path) -> JobStore:
    return JobStore(LocalObjects(folder), Spool(folder / "incoming"))


@pytest.fixture
def disk(store: JobStore, monkeypatch: pytest.MonkeyPatch) -> Disk:
    del store  # has made its folders
    return Disk(monkeypatch)


def after_crash(disk: Disk, folder: Path, name: str) -> JobStore:
    left = disk.leave(folder, folder.parent / name)
    return JobStore(LocalObjects(left), Spool(left / "incoming"))


def a_job() -> Job:
    return Job(
        id=new_job_id(),
        sha256="0" * 64,
        size_bytes=4,
        mesh_format=None,
        parameters={},
        created_at=now(),
        webhook_url="https://example.com/",
    )


def accept(store: JobStore, job: Job, disk: Disk | None = None, folder: Path | None = None) -> None:
    def begin() -> None:
        assert store.records.job(job.id) == job
        if disk is not None and folder is not None:
            assert unfinished(after_crash(disk, folder, "begun")) == {}
            files = [one for one in (folder / "jobs" / job.id).iterdir() if one.is_file()]
            assert len(files) == 2  # of which any may have kept its name
            assert all(map(disk.has_bytes, files))

    with store.spool.begin_upload() as upload:
        upload.write(b"mesh")
        store.accept(job, upload, begin)


def test_a_job_survives_from_the_end_of_its_acceptance_on(store: JobStore, disk: Disk, folder: Path) -> None:
    job = a_job()
    accept(store, job, disk, folder)
    left = after_crash(disk, folder, "accepted")
    assert left.records.job(job.id) == job
    assert left.pending.oldest_of(None, 10) == [job.id]
    assert [one.id for one in left.page(None, None, 10).jobs] == [job.id]
    assert left.outbox.delivery(job.id) == Delivery()
    with left.open_mesh(job.id) as mesh:
        assert mesh.read() == b"mesh"


def test_a_repeated_submission_waits_for_the_acceptance_of_the_first(store: JobStore, disk: Disk, folder: Path) -> None:
    job = a_job()

    def repeat() -> None:
        with store.spool.begin_upload() as upload, pytest.raises(JobExists):
            store.accept(job, upload)
        assert after_crash(disk, folder, "repeated").records.job(job.id) == job

    with store.spool.begin_upload() as upload:
        upload.write(b"mesh")
        store.accept(job, upload, repeat)


def test_an_outcome_and_its_result_survive_from_the_end_of_finish_on(store: JobStore, disk: Disk, folder: Path) -> None:
    job = a_job()
    accept(store, job)
    store.results.write(job.id, lambda target: target.write(b"result"))
    outcome = Succeeded(finished_at=now(), faces=4, vertices=4, max_segments=3, automatic_segments=2)

    def announce() -> None:
        assert store.records.outcome(job.id) == outcome
        left = after_crash(disk, folder, "announced")
        assert left.records.outcome(job.id) is None
        assert list(unfinished(left)) == [job.id]

    store.finish(job.id, outcome, announce)
    left = after_crash(disk, folder, "finished")
    assert left.records.outcome(job.id) == outcome
    assert left.objects.get(job_key(job.id, RESULT)) == b"result"
