"""Labels that were made elsewhere, stored as the next revision of a job."""

from dataclasses import dataclass

from segcore.levels import Level
from service.answer.label_formats import LABELS, labels_rendition
from service.answer.renditions import rendition_tag
from service.answer.revision import NEWEST, chosen_cut
from service.context import Context
from service.edit.label_uploads import read_labels
from service.edit.parts import parts_of
from service.edit.revising import RequestKey, Revised, check_base, conflict, made_before, store_parts
from service.guard.callers import Caller
from worker.jobs.job import Job


@dataclass(frozen=True, slots=True)
class LabelUpload:
    """A request to store labels."""

    body: bytes
    media_type: str
    base: int | None  # the newest revision; None for that of if_match, or 0
    if_match: str | None
    request: RequestKey | None


def store_labels(context: Context, caller: Caller, job: Job, upload: LabelUpload) -> Revised:
    """Store labels as the next revision.

    Raises
    ------
    UnknownJob, Problem
        If the job has no result, the base is not the newest revision, or the format is not known.
    UnknownRevision, RevisionDamaged
    InvalidParameters
        If the labels are not those of the mesh.
    """
    newest = context.store.revisions.newest(job.id)
    if upload.if_match is not None and not _matches(context, job, upload.if_match):
        raise conflict(context, job, "precondition_failed")
    base = upload.base if upload.base is not None else newest if upload.if_match is not None else 0
    check_base(base, newest)
    before = parts_of(context.results, job.id, base, Level())
    if base != newest:
        return made_before(context, job, base, before, upload.request)
    after = read_labels(upload.body, upload.media_type, len(before.labels))
    return store_parts(context, caller, job, base, before, after, "labels made elsewhere", upload.request)


def _matches(context: Context, job: Job, if_match: str) -> bool:
    """Whether If-Match has the ETag of the newest labels in any format."""
    wanted = {tag.strip() for tag in if_match.split(",")}
    if "*" in wanted:
        return True
    cut = chosen_cut(context, job, Level(), NEWEST)
    renditions = (labels_rendition(cut, name, "*/*") for name in LABELS)
    return any(rendition_tag(one, is_gzip=is_gzip) in wanted for one in renditions for is_gzip in (False, True))
