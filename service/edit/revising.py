"""From an edit to a stored revision: its base is checked, its operations are applied, and the parts are stored."""

import hashlib
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

from segcore import Partition
from segcore.edit.operations import Operation, Restore, apply_all, in_words
from segcore.edit.tools import PartFinder, Tools
from segcore.levels import Level
from service.context import Context
from service.edit.parts import parts_of
from service.edit.result_documents import revision_document
from service.guard.callers import Caller
from service.lookup import check_succeeded
from service.problems import Problem
from service.result_cache import ResultCache
from worker.edits.operation_documents import EditDocument
from worker.jobs.job import Job, now
from worker.jobs.revision import Revision, words_of_revision
from worker.jobs.store.revisions import RevisionDamaged, RevisionExists, UnknownRevision

EDIT_PROBLEMS = (
    "revision_conflict",
    "revision_not_found",
    "revision_damaged",
    "part_locked",
    "invalid_parameters",
    "idempotency_key_reused",
)


@dataclass(frozen=True, slots=True)
class RequestKey:
    """Identifies a request that is sent again."""

    key: str  # derived from the Idempotency-Key
    content: str  # a hash of the body


@dataclass(frozen=True, slots=True, eq=False)
class Edit:
    """A checked edit of the newest revision."""

    job: Job
    base: int
    before: Partition
    document: EditDocument
    operations: Sequence[Operation]
    request: RequestKey | None

    @property
    def needs_guide(self) -> bool:
        return any(operation.needs_guide for operation in self.operations)

    @property
    def words(self) -> str:
        return words_of_revision(in_words(self.operations))


@dataclass(frozen=True, slots=True, eq=False)
class Revised:
    """A stored revision, and the parts before and after it."""

    revision: Revision
    before: Partition
    after: Partition


def request_key(
    context: Context, caller: Caller, job: Job, idempotency_key: str | None, body: bytes
) -> RequestKey | None:
    """Return what identifies a request with an Idempotency-Key; None if it has none."""
    if idempotency_key is None:
        return None
    key = context.secret.derive("edit", caller.owner or "", job.id, idempotency_key).hex()
    return RequestKey(key, hashlib.sha256(body).hexdigest())


def begin_edit(context: Context, job: Job, document: EditDocument, request: RequestKey | None) -> Edit | Revised:
    """Check an edit, or return the revision that the same request has made before.

    Raises
    ------
    UnknownJob, Problem
        If the job has no result, or the base is not the newest revision.
    UnknownRevision, RevisionDamaged
    InvalidParameters
        If an operation contradicts itself, or there is no such level.
    """
    check_succeeded(context, job)
    operations, level = document.all(), document.level_of_base(document.base)
    newest = context.store.revisions.newest(job.id)
    check_base(document.base, newest)
    before = _parts_before(context, job, document.base, level, operations)
    if document.base != newest:
        return made_before(context, job, document.base, before, request)
    return Edit(job, document.base, before, document, operations, request)


def _parts_before(context: Context, job: Job, base: int, level: Level, operations: Sequence[Operation]) -> Partition:
    """Return the parts of the base; if they are lost and are replaced at once, those of the automatic result."""
    try:
        return parts_of(context.results, job.id, base, level)
    except RevisionDamaged:
        if not isinstance(operations[0], Restore):
            raise
        return parts_of(context.results, job.id, 0, Level())


def check_base(base: int, newest: int) -> None:
    """Raise UnknownRevision if a base is newer than the newest revision."""
    if base > newest:
        raise UnknownRevision(base)


def applied(results: ResultCache, edit: Edit) -> Partition:
    """Return the parts after an edit that needs no Guide.

    Raises
    ------
    InvalidParameters, PartLocked
        If an operation cannot be applied.
    UnknownRevision, RevisionDamaged
        If a revision cannot be restored.
    """
    tools = Tools(_no_guide, lambda number, level: parts_of(results, edit.job.id, number, level))
    return apply_all(edit.before, edit.operations, tools)


def _no_guide() -> PartFinder:
    raise AssertionError("operations that need a Guide are applied in another process")


def store_edit(context: Context, caller: Caller, edit: Edit, after: Partition) -> Revised:
    """Store the parts after an edit as the next revision; errors as of :func:`store_parts`."""
    return store_parts(context, caller, edit.job, edit.base, edit.before, after, edit.words, edit.request)


def store_parts(
    context: Context,
    caller: Caller,
    job: Job,
    base: int,
    before: Partition,
    after: Partition,
    what: str,
    request: RequestKey | None,
) -> Revised:
    """Store parts as the revision after a base.

    Raises
    ------
    UnknownJob
        If the job was deleted.
    Problem
        If another edit of the base was stored first, unless it is this one, sent before.
    """
    revision = Revision(
        number=base + 1,
        parent=base,
        made_at=now(),
        made_by=caller.owner,
        what=what,
        parts=len(after),
        request=None if request is None else request.key,
        content=None if request is None else request.content,
    )
    try:
        context.store.revisions.add(job.id, revision, after)
    except RevisionExists:
        return made_before(context, job, base, before, request)
    return Revised(revision, before, after)


def made_before(context: Context, job: Job, base: int, before: Partition, request: RequestKey | None) -> Revised:
    """Return the revision after a base if the same request has made it; else raise the conflict."""
    made = context.store.revisions.revision(job.id, base + 1)
    if request is not None and made.request == request.key:
        if made.content != request.content:
            raise Problem("idempotency_key_reused", "This Idempotency-Key was sent with another edit: use a new key.")
        return Revised(made, before, parts_of(context.results, job.id, made.number, Level()))
    raise conflict(context, job, "revision_conflict")


def conflict(context: Context, job: Job, code: str) -> Problem:
    """Return the problem of an edit of a revision that is not the newest one."""
    number = context.store.revisions.newest(job.id)
    newest = None
    with suppress(RevisionDamaged, UnknownRevision):
        newest = revision_document(context.store.revisions.revision(job.id, number))
    return Problem(code, revision=newest)
