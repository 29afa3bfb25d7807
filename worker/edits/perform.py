"""Runs an edit that waited in the queue: ``python -m worker.edits.perform ID``, with the settings of the environment.

A process of its own opens the store itself, so that it works with a bucket, which a forked process cannot use. Running
an edit again after a crash changes nothing: the revision names the request that has made it.
"""

import logging
import os
import sys
from functools import cache

import segcore
from cleave.logs import configure_logging
from cleave.parent_death import die_with_parent
from cleave.settings import Settings, load_settings
from segcore import CleaveError, Partition
from segcore.edit.operations import Restore, apply_all, in_words
from segcore.edit.tools import PartFinder, Tools
from segcore.io import Segmentation, read_result
from segcore.levels import Level
from worker.edits.operation_documents import EditDocument
from worker.jobs.job import now
from worker.jobs.queued_edit import EditOutcome, QueuedEdit
from worker.jobs.revision import Revision, words_of_revision
from worker.jobs.store.opening import open_store
from worker.jobs.store.revisions import RevisionDamaged, RevisionExists, UnknownRevision
from worker.jobs.store.store import JobStore, UnknownJob
from worker.process.work_horse import exit_status, limit_resources

log = logging.getLogger("cleave.worker")

_CONFLICT = "Somebody has edited the job since this edit was sent: look at the newest revision, and send it again."


def perform_edit(store: JobStore, edit_id: str) -> None:
    """Give a waiting edit its outcome; do nothing if it has ended or its job was deleted."""
    edit = store.queued_edits.waiting(edit_id)
    if edit is None:
        return
    try:
        outcome = _outcome(store, edit)
        store.queued_edits.end(edit, outcome)
    except UnknownJob:
        return
    log.info("edit %s of job %s: %s", edit.id, edit.job_id, outcome.code or f"revision {outcome.revision}")


def _outcome(store: JobStore, edit: QueuedEdit) -> EditOutcome:
    try:
        number = _revised(store, edit)
        return EditOutcome(ended_at=now(), revision=number)
    except CleaveError as error:
        return EditOutcome(ended_at=now(), code=error.code, message=str(error))
    except RevisionExists:
        return EditOutcome(ended_at=now(), code="revision_conflict", message=_CONFLICT)
    except UnknownRevision as error:
        message = f"There is no revision {error.args[0]}."
        return EditOutcome(ended_at=now(), code="revision_not_found", message=message)
    except RevisionDamaged as error:
        message = f"The store has lost revision {error.args[0]}: restore an earlier one."
        return EditOutcome(ended_at=now(), code="revision_damaged", message=message)


def _revised(store: JobStore, edit: QueuedEdit) -> int:
    """Make the revision of an edit, unless an earlier run has made it, and return its number."""
    document = EditDocument.model_validate(edit.edit)
    number = document.base + 1
    if store.revisions.newest(edit.job_id) >= number:
        if store.revisions.revision(edit.job_id, number).request == edit.request:
            return number
        raise RevisionExists(number)
    after, operations = parts_after(store, edit.job_id, document), document.all()
    made = Revision(
        number=number,
        parent=document.base,
        made_at=now(),
        made_by=edit.made_by,
        what=words_of_revision(in_words(operations)),
        parts=len(after),
        request=edit.request,
        content=edit.content,
    )
    store.revisions.add(edit.job_id, made, after)
    return number


def parts_after(store: JobStore, job_id: str, document: EditDocument) -> Partition:
    """Return the parts of a job after an edit.

    Raises
    ------
    CleaveError
        If an operation cannot be applied.
    UnknownJob, UnknownRevision, RevisionDamaged
    """
    if store.records.job(job_id) is None:
        raise UnknownJob(job_id)
    with store.results.open(job_id) as file:
        result = read_result(file)

    def parts_of(revision: int, level: Level) -> Partition:
        return store.revisions.partition(job_id, revision) if revision else Partition(level.labels(result.hierarchy))

    operations, level = document.all(), document.level_of_base(document.base)
    is_replaced = isinstance(operations[0], Restore)  # then the parts of the base may be lost
    before = parts_of(0, Level()) if is_replaced else parts_of(document.base, level)
    return apply_all(before, operations, Tools(cache(lambda: guide_of(result)), parts_of))


def guide_of(result: Segmentation) -> PartFinder:
    """Return the Guide of the result of a job."""
    return segcore.Guide(result.mesh, result.hierarchy)


def run(settings: Settings, edit_id: str) -> int:
    """Run an edit within the limits of a job and return the exit status."""
    limit_resources(settings)
    store = open_store(settings)
    return exit_status(lambda: perform_edit(store, edit_id))


if __name__ == "__main__":
    die_with_parent(os.getppid())
    chosen = load_settings()
    configure_logging(chosen.log_level, chosen.log_format, "edit")
    os._exit(run(chosen, sys.argv[1]))
