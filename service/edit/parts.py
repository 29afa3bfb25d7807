"""The parts of a job at any of its revisions."""

from segcore import Partition
from segcore.levels import Level
from service.result_cache import ResultCache


def parts_of(results: ResultCache, job_id: str, revision: int, level: Level) -> Partition:
    """Return the parts of a revision of a job, or of a level of revision 0.

    Raises
    ------
    UnknownJob, UnknownRevision, RevisionDamaged
    InvalidParameters
        If there is no such level.
    """
    if revision == 0:
        return Partition(level.labels(results.get(job_id).hierarchy))
    edited = results.revised(job_id, revision).edited
    assert edited is not None, "a revision has parts"
    return edited.partition
