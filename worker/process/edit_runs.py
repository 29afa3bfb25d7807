"""Runs edits that wait in the queue, each in a process of its own, for a worker."""

import logging
import os
import subprocess
import sys
from collections.abc import Callable

from cleave.settings import Settings
from worker.jobs.job import now
from worker.jobs.queued_edit import FAILURES, EditFailure, EditOutcome, QueuedEdit
from worker.jobs.store.records import UnknownJob
from worker.jobs.store.store import JobStore
from worker.process.watch import Watch
from worker.process.work_horse import Ending, ending_of, out_of_memory_kills

log = logging.getLogger("cleave.worker")


class EditRuns:
    """Runs edits until each has an outcome, or has had all its attempts."""

    def __init__(self, store: JobStore, settings: Settings, watch: Watch) -> None:
        self._store = store
        self._settings = settings
        self._watch = watch

    def run(self, edit: QueuedEdit, on_tick: Callable[[], None]) -> bool:
        """Run an edit once; return whether it has ended, and need not wait in the queue again.

        Parameters
        ----------
        on_tick : called about once a second.

        Raises
        ------
        OSError
            If the store does not answer.
        """
        attempt = self._store.queued_edits.begin(edit)
        if attempt > self._settings.max_attempts:  # the worker has died in the last one
            self._give_up(edit, "worker_lost")
            return True
        ending = self._run_process(edit, on_tick)
        if self._has_ended(edit):
            return True
        log.warning("edit %s: run %d ended with %s", edit.id, attempt, ending)
        if ending in ("shutdown", "cannot store"):  # not the fault of the edit
            self._store.queued_edits.withdraw(edit, attempt)
            return False
        if attempt < self._settings.max_attempts:
            return False
        self._give_up(edit, ending if ending in FAILURES else "worker_lost")
        return True

    def _run_process(self, edit: QueuedEdit, on_tick: Callable[[], None]) -> Ending:
        kills_before = out_of_memory_kills()
        ended, held_by_the_process = os.pipe()
        process = subprocess.Popen(
            [sys.executable, "-m", "worker.edits.perform", edit.id],
            env=os.environ | _environment(self._settings),
            pass_fds=[held_by_the_process],
            start_new_session=True,  # signals to the group of the worker do not end it
        )
        os.close(held_by_the_process)
        stopped_for = self._watch.wait(process.pid, ended, has_ended=lambda: self._has_ended(edit), on_tick=on_tick)
        status = process.wait()
        return stopped_for or ending_of(status << 8 if status >= 0 else -status, kills_before)

    def _has_ended(self, edit: QueuedEdit) -> bool:
        is_over = self._store.queued_edits.outcome(edit.job_id, edit.id) is not None
        return is_over or not self._store.records.has_job(edit.job_id)

    def _give_up(self, edit: QueuedEdit, code: EditFailure) -> None:
        try:
            self._store.queued_edits.end(edit, EditOutcome(ended_at=now(), code=code, message=FAILURES[code]))
        except UnknownJob:
            log.info("job %s was deleted", edit.job_id)


def _environment(settings: Settings) -> dict[str, str]:
    """The settings as variables, because they may have come from elsewhere."""
    given = settings.model_dump(mode="json", exclude_none=True)
    return {f"CLEAVE_{name.upper()}": str(value) for name, value in given.items()}
