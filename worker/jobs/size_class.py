"""Size classes of jobs, which have separate queues so that small jobs do not wait for large ones."""

from enum import StrEnum

from worker.jobs.job import Job


class SizeClass(StrEnum):
    SMALL = "small"
    LARGE = "large"


def size_class(job: Job, large_job_bytes: int) -> SizeClass:
    """Return the size class of a job from the size of its file, as the mesh is not read before the job runs."""
    return SizeClass.LARGE if job.size_bytes >= large_job_bytes else SizeClass.SMALL
