"""The result file of a job with the parts of a revision."""

from segcore.io import Edited, RevisionNote, write_result
from segcore.levels import Level
from service.answer.renditions import Rendition, to_bytes
from service.answer.revision import NEWEST, chosen_cut, revision_number
from service.context import Context
from worker.jobs.job import Job
from worker.jobs.revision import Revision

_MEDIA_TYPE = "application/octet-stream"
_MOST_NOTES = 10_000  # revisions that a file lists, the newest ones; set by hand


def edited_file(context: Context, job: Job, revision: str) -> Rendition:
    """Return the mesh, its hierarchy, the parts of a revision and the list of revisions as one file.

    Raises
    ------
    UnknownJob, Problem
        If the job has no result.
    UnknownRevision, RevisionDamaged
    """
    number = revision_number(context, job, revision)
    cut = chosen_cut(context, job, Level(), str(number))

    def write() -> bytes:
        result = context.results.get(job.id)
        edited = None if cut.partition is None else Edited(cut.partition, _notes(context, job, number))
        return to_bytes(lambda target: write_result(target, result.mesh, result.hierarchy, edited))

    return Rendition(
        identity=f"{job.id}/result.cleave" + ("" if cut.partition is None else f"?revision={number}"),
        media_type=_MEDIA_TYPE,
        render=write,
        file_name=f"{job.id}.cleave",
        may_change=revision == NEWEST,
    )


def _notes(context: Context, job: Job, number: int) -> tuple[RevisionNote, ...]:
    page = context.store.revisions.page(job.id, number + 1, _MOST_NOTES)
    return tuple(_note(revision) for revision in reversed(page.revisions))


def _note(revision: Revision) -> RevisionNote:
    return RevisionNote(
        number=revision.number,
        parent=revision.parent,
        made_at=revision.made_at.isoformat(),
        made_by=revision.made_by,
        what=revision.what,
        parts=revision.parts,
    )
