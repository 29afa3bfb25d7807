"""Workers that run edits: once each, again after a crash, and not for ever."""

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

import pytest

from cleave.settings import Settings
from helpers.jobs import SMALL, accepted, sphere
from helpers.processes import StartWorker
from helpers.waiting import wait_until
from worker.edits.perform import perform_edit
from worker.jobs.job import new_job_id, now
from worker.jobs.queue.queue import JobQueue
from worker.jobs.queued_edit import EditOutcome, QueuedEdit
from worker.jobs.store.store import JobStore
from worker.process.edit_runs import EditRuns
from worker.process.perform import perform
from worker.process.watch import Watch

NAME = {"base": 0, "operations": [{"op": "name", "part": 0, "name": "body"}]}


def queued(store: JobStore, settings: Settings, edit: dict[str, object]) -> QueuedEdit:
    """Return an accepted edit of a finished job."""
    job = accepted(store, sphere(4))
    perform(store, settings, job.id, lambda *_: None)
    made = QueuedEdit(
        id=new_job_id(), job_id=job.id, accepted_at=now(), made_by="me", request=new_job_id(), content=None, edit=edit
    )
    store.queued_edits.accept(made)
    return made


def ended(store: JobStore, edit: QueuedEdit) -> EditOutcome:
    wait_until(lambda: store.queued_edits.outcome(edit.job_id, edit.id) is not None)
    outcome = store.queued_edits.outcome(edit.job_id, edit.id)
    assert outcome is not None
    return outcome


@pytest.fixture
def settings(tmp_path: Path, queue_url: str) -> Settings:
    return Settings(data_dir=tmp_path / "data", redis_url=queue_url)


def test_a_worker_makes_the_revision_of_an_edit_that_the_janitor_finds(
    start_worker: StartWorker,
    start_janitor: Callable[[], None],
    store: JobStore,
    settings: Settings,
    queue: JobQueue,
) -> None:
    edit = queued(store, settings, NAME)
    lost = queued(store, settings, NAME)
    queue.enqueue(edit.id, SMALL)
    start_worker()
    start_janitor()
    for one in (edit, lost):
        assert ended(store, one).revision == 1
        made = store.revisions.revision(one.job_id, 1)
        assert (made.what, made.made_by, made.request) == ("name part 0 'body'", "me", one.request)
        assert store.revisions.partition(one.job_id, 1).names == {0: "body"}
    wait_until(lambda: queue.held([edit.id, lost.id]) == set())
    assert store.queued_edits.waiting_ids() == []


def test_an_edit_whose_process_dies_every_time_is_given_up(store: JobStore, settings: Settings) -> None:
    small = settings.model_copy(update={"job_memory_bytes": 2**20, "max_attempts": 2})
    edit = queued(store, settings, NAME)
    runs = EditRuns(store, small, Watch(small))
    assert not runs.run(edit, on_tick=lambda: None)
    assert runs.run(edit, on_tick=lambda: None)
    assert ended(store, edit).code in ("worker_lost", "out_of_memory")
    assert store.revisions.newest(edit.job_id) == 0


def test_a_run_after_a_crash_finds_the_revision_of_the_one_before(store: JobStore, settings: Settings) -> None:
    edit = queued(store, settings, NAME)
    perform_edit(store, edit.id)
    store.objects.delete(f"jobs/{edit.job_id}/edits/{edit.id}.ended")  # as if it had been killed before the end
    store.queued_edits.accept(edit)
    perform_edit(store, edit.id)
    assert ended(store, edit).revision == 1
    assert store.revisions.newest(edit.job_id) == 1
    other = QueuedEdit(**{**asdict(edit), "id": new_job_id(), "request": "other"})
    store.queued_edits.accept(other)
    perform_edit(store, other.id)
    assert ended(store, other).code == "revision_conflict"
