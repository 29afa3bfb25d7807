"""The revision whose parts a request selects."""

from typing import Annotated

from fastapi import Depends, Query

from segcore.errors import InvalidParameters
from segcore.levels import Level
from service.answer.level import ChosenCut, cut_at, revised_cut
from service.context import Context
from service.lookup import check_succeeded
from worker.jobs.job import Job

NEWEST = "latest"
REVISION_PATTERN = r"^(latest|0|[1-9][0-9]{0,7})$"
REVISION_PROBLEMS = ("revision_not_found", "revision_damaged")  # codes that chosen_cut raises


async def _revision(
    revision: Annotated[
        str | None,
        Query(
            pattern=REVISION_PATTERN,
            description="The parts after an edit: the number of a revision, or latest; by default 0, the automatic "
            "result. Names and colours are those of the revision.",
            examples=["latest"],
        ),
    ] = None,
) -> str | None:
    return revision


RevisionOf = Annotated[str | None, Depends(_revision)]


def revision_number(context: Context, job: Job, revision: str | None) -> int:
    """Return the number of the revision of a job that a request names; 0 if it names none."""
    return context.store.revisions.newest(job.id) if revision == NEWEST else int(revision or 0)


def chosen_cut(context: Context, job: Job, level: Level, revision: str | None) -> ChosenCut:
    """Return the result of a job at a level or with the parts of a revision.

    Raises
    ------
    UnknownJob, Problem
        If the job has no result.
    UnknownRevision, RevisionDamaged
    InvalidParameters
        If the hierarchy has no such level, or a level and a revision are given.
    """
    check_succeeded(context, job)
    if revision == NEWEST and not level.is_automatic:
        raise InvalidParameters("A revision has no levels: give a level or revision=latest, not both.")
    number = revision_number(context, job, revision)
    if number == 0:
        cut = cut_at(job.id, context.results.get(job.id), level)
        return cut.of_newest() if revision == NEWEST else cut
    if not level.is_automatic:
        raise InvalidParameters("A revision has no levels: give a level or a revision, not both.")
    return revised_cut(job.id, context.results.revised(job.id, number), number, is_newest=revision == NEWEST)
