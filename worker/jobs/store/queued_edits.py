"""The edits that wait in the queue.

An edit has a marker from before its acceptance until after its end, so that the janitor finds it if the queue loses it.
The record is created after the marker: the edit is accepted. The outcome is created once: the edit has ended.
"""

import time

from pydantic import TypeAdapter

from worker.jobs.job import is_job_id
from worker.jobs.objects.interface import ObjectStorage
from worker.jobs.queued_edit import EditOutcome, QueuedEdit
from worker.jobs.store.layout import QUEUED_EDITS, job_key
from worker.jobs.store.records import Records

_EDIT = TypeAdapter(QueuedEdit)
_OUTCOME = TypeAdapter(EditOutcome)
_GRACE_S = 3600.0  # the record of a younger marker may still be written; set by hand


class QueuedEdits:
    """Writes raise UnknownJob if the job has been deleted, also during the write."""

    def __init__(self, objects: ObjectStorage, records: Records) -> None:
        self._objects = objects
        self._records = records

    def accept(self, edit: QueuedEdit) -> None:
        """Store an edit; once this returns, it will end even if the queue is lost. The first of one id stays."""
        self._records.require(edit.job_id)
        self._objects.put(_marker(edit.id), edit.job_id.encode())
        self._objects.create(_key(edit.job_id, edit.id), _EDIT.dump_json(edit))
        self._records.require(edit.job_id, lambda: self._remove(edit.job_id, edit.id))

    def find(self, job_id: str, edit_id: str) -> QueuedEdit | None:
        """Return an edit of a job that was accepted, also if it has ended."""
        text = self._objects.get(_key(job_id, edit_id)) if is_job_id(edit_id) else None
        return None if text is None else _EDIT.validate_json(text)

    def waiting(self, edit_id: str) -> QueuedEdit | None:
        """Return an edit that has not ended; None if there is none of this id."""
        job_id = (self._objects.get(_marker(edit_id)) or b"").decode()
        return self.find(job_id, edit_id) if is_job_id(job_id) and self._records.has_job(job_id) else None

    def waiting_ids(self) -> list[str]:
        """Return the edits that have not ended, and remove the markers of those that do not exist."""
        oldest = time.time() - _GRACE_S
        found = []
        for one in self._objects.list_below(QUEUED_EDITS):
            if self.waiting(one.name) is not None:
                found.append(one.name)
            elif one.modified_at < oldest:
                self._objects.delete(one.key)
        return found

    def begin(self, edit: QueuedEdit) -> int:
        """Count one more run of an edit, before it starts, and return which one it is: 1, 2, ..."""
        number = 1
        while not self._objects.create(_run_key(edit, number), f"{time.time()}".encode()):
            number += 1
        return number

    def withdraw(self, edit: QueuedEdit, number: int) -> None:
        """Do not count a run that was stopped for a reason that is not the fault of the edit."""
        self._objects.delete(_run_key(edit, number))

    def outcome(self, job_id: str, edit_id: str) -> EditOutcome | None:
        """Return how an edit has ended; None if it has not."""
        text = self._objects.get(f"{_folder(job_id)}/{edit_id}.ended")
        return None if text is None else _OUTCOME.validate_json(text)

    def end(self, edit: QueuedEdit, outcome: EditOutcome) -> None:
        """Give an edit its outcome, unless it has one."""
        key = f"{_folder(edit.job_id)}/{edit.id}.ended"
        self._objects.create(key, _OUTCOME.dump_json(outcome))
        self._objects.delete(_marker(edit.id))
        self._records.require(edit.job_id, lambda: self._objects.delete(key))

    def _remove(self, job_id: str, edit_id: str) -> None:
        self._objects.delete(_key(job_id, edit_id))
        self._objects.delete(_marker(edit_id))


def _folder(job_id: str) -> str:
    return job_key(job_id, "edits")


def _key(job_id: str, edit_id: str) -> str:
    return f"{_folder(job_id)}/{edit_id}.json"


def _run_key(edit: QueuedEdit, number: int) -> str:
    return f"{_folder(edit.job_id)}/{edit.id}.run-{number}"


def _marker(edit_id: str) -> str:
    if not is_job_id(edit_id):
        raise ValueError(f"Not the id of an edit: {edit_id!r}.")
    return f"{QUEUED_EDITS}/{edit_id}"
