"""A request for a result of a job at a level, as a dependency of routes."""

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request

from service.answer.level import ChosenCut, LevelOf
from service.answer.revision import RevisionOf, chosen_cut
from service.context import ContextOf
from service.guard.callers import CallerOf
from service.lookup import JobId, find_job


@dataclass(frozen=True, slots=True)
class ResultRequest:
    """What a request specifies; nothing is looked up before :meth:`cut` is called."""

    job_id: JobId
    request: Request
    context: ContextOf
    caller: CallerOf
    level: LevelOf
    revision: RevisionOf

    def cut(self) -> ChosenCut:
        """Return the result of the job at the requested level.

        Raises
        ------
        UnknownJob, Problem
            If the caller has no such job, or the job has no result or no such revision.
        InvalidParameters
            If the hierarchy has no such level, or a level and a revision are given.
        """
        job = find_job(self.context, self.caller, self.job_id)
        return chosen_cut(self.context, job, self.level, self.revision)


ResultRequestOf = Annotated[ResultRequest, Depends()]
