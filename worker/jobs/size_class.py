"""Small jobs and large ones, which wait apart, so that a mesh of a million faces holds up none of ten thousand."""

from enum import StrEnum

from worker.jobs.job import Job


class SizeClass(StrEnum):
    SMALL = "small"
    LARGE = "large"


def size_class(job: Job, large_job_bytes: int) -> SizeClass:
    """Where a job waits: told from its record alone, as nobody has looked into the mesh when it is accepted."""
    return SizeClass.LARGE if job.size_bytes >= large_job_bytes else SizeClass.SMALL
