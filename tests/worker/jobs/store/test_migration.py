"""Stores of earlier versions: they are used at once, and every object has a present name in the end."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from helpers.jobs import accepted, unfinished
from helpers.storage.failures import killed_at_every_write
from worker.jobs.job import Canceled, Job, now
from worker.jobs.objects.interface import name_of
from worker.jobs.store import deletion, index
from worker.jobs.store.index import complemented
from worker.jobs.store.layout import DELETED, ENDED, TIMELINE, LayoutVersion, entry_name
from worker.jobs.store.migration import Migration
from worker.jobs.store.opening import open_folder
from worker.jobs.store.spool import Spool
from worker.jobs.store.store import JobStore


def fill(store: JobStore) -> tuple[list[Job], Job]:
    """Put jobs of an owner in a store, of which the first two have ended, and one that was deleted."""
    jobs = [accepted(store, b"mesh", "me") for _ in range(5)]
    for job in jobs[:2]:
        store.finish(job.id, Canceled(finished_at=now()))
    deleted = accepted(store, b"mesh", None)
    store.delete(deleted.id)
    make_earlier(store)
    return jobs, deleted


def make_earlier(store: JobStore) -> None:
    """Give the objects of a store the names of the version before this one."""
    for key in store.objects.keys_below(TIMELINE):
        store.objects.put(f"{index.EARLIER}/{key.split('/')[1]}/{name_of(key)}", b"")
        store.objects.delete(key)
    for key in store.objects.keys_below(DELETED):
        store.objects.put(f"{deletion.EARLIER}/{name_of(key)}", store.objects.get(key) or b"")
        store.objects.delete(key)
    for key in store.objects.keys_below(ENDED):
        store.objects.delete(key)
    store.objects.delete("layout")


def pages(store: JobStore, owner: str) -> Iterator[Job]:
    page = store.page(owner, None, 2)
    yield from page.jobs
    while page.next_cursor:
        page = store.page(owner, page.next_cursor, 2)
        yield from page.jobs


def migrate(store: JobStore) -> None:
    migration = Migration(store)
    while migration.step():
        pass


@pytest.fixture
def small_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worker.jobs.store.migration._STEP", 2)


def test_an_earlier_store_is_used_as_before_during_the_migration(any_store: JobStore, small_steps: None) -> None:
    del small_steps
    jobs, deleted = fill(any_store)
    migration = Migration(any_store)
    is_left = True
    while is_left:
        is_left = migration.step()
        assert list(pages(any_store, "me")) == jobs[::-1]
        assert any_store.deletions.was_deleted(deleted.id, None)
        assert list(unfinished(any_store)) == [job.id for job in jobs if any_store.records.outcome(job.id) is None]
        if len(jobs) < 7:
            jobs.append(accepted(any_store, b"mesh", "me"))
    assert LayoutVersion(any_store.objects).is_current()
    for folder in (index.EARLIER, deletion.EARLIER):
        assert any_store.objects.keys_below(folder) == []
    assert [one.id for one in any_store.ended.oldest("", 10)] == [job.id for job in jobs[:2]]


def test_jobs_can_be_deleted_before_they_are_migrated(any_store: JobStore) -> None:
    jobs, _ = fill(any_store)
    any_store.delete(jobs[0].id)
    assert list(pages(any_store, "me")) == jobs[:0:-1]
    migrate(any_store)
    assert list(pages(any_store, "me")) == jobs[:0:-1]
    assert [one.id for one in any_store.ended.oldest("", 10)] == [jobs[1].id]


def test_a_migration_that_is_killed_loses_nothing(store: JobStore, tmp_path: Path) -> None:
    filled = fill(store)

    def prepare() -> None:
        nonlocal filled
        for job in filled[0]:
            store.delete(job.id)
        migrate(store)
        store.deletions.forget(-10.0)
        filled = fill(store)

    def reopened(objects: object) -> JobStore:
        return JobStore(objects, Spool(tmp_path / "incoming"))  # type: ignore[arg-type]

    for _ in killed_at_every_write(store.objects, lambda failing: migrate(reopened(failing)), prepare):
        jobs, deleted = filled
        assert list(pages(reopened(store.objects), "me")) == jobs[::-1]
        migrate(reopened(store.objects))
        assert list(pages(reopened(store.objects), "me")) == jobs[::-1]
        assert store.deletions.was_deleted(deleted.id, None)
        assert [one.id for one in store.ended.oldest("", 100) if one.id in {job.id for job in jobs}] == [
            job.id for job in jobs[:2]
        ]


def test_a_new_store_needs_no_migration_after_the_first_step(any_store: JobStore) -> None:
    migration = Migration(any_store)
    assert not migration.step()
    assert LayoutVersion(any_store.objects).is_current()


def test_a_step_that_fails_is_repeated(store: JobStore, monkeypatch: pytest.MonkeyPatch) -> None:
    jobs, _ = fill(store)
    migration = Migration(store)

    def fail(keys: list[str]) -> None:
        raise OSError(f"no disk for {len(keys)} objects")

    with monkeypatch.context() as broken:
        broken.setattr(store.objects, "sync", fail)
        with pytest.raises(OSError, match="no disk"):
            migration.step()
    while migration.step():
        pass
    assert list(pages(store, "me")) == jobs[::-1]


def test_a_data_folder_of_the_first_version_is_renamed_when_it_is_opened(tmp_path: Path) -> None:
    folder = tmp_path / "data"
    store = open_folder(folder)
    ended, job = accepted(store, b"mesh", "me"), accepted(store, b"mesh", "me")
    store.finish(ended.id, Canceled(finished_at=now()))
    make_earlier(store)
    for one in (job, ended):
        (folder / "jobs" / one.id / f"mesh-{one.sha256}").rename(folder / "jobs" / one.id / "mesh")
        entry = folder / "index" / "me" / complemented(entry_name(one))
        entry.rename(entry.with_name(entry_name(one)))
    (folder / "pending" / f"{entry_name(job)}.me").rename(folder / "pending" / f"{job.id}.me")
    (folder / "computed" / "me").mkdir(parents=True)
    (folder / "computed" / "me" / "0123").write_text(ended.id)
    store = open_folder(folder)
    assert unfinished(store) == {job.id: "me"}
    assert store.page("me", None, 10).jobs == [job, ended]
    with store.open_mesh(job.id) as mesh:
        assert mesh.read() == b"mesh"
    migrate(store)
    assert not (folder / "computed" / "me" / "0123").exists()
    assert store.page("me", None, 10).jobs == [job, ended]
