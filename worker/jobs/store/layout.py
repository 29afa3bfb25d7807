"""The names of the objects in a store.

    pending/<time>-<id>[.<owner>]   empty: the job has no outcome yet; made before the job is accepted
    index/<owner>/<time>-<id>       empty: which jobs there are, by time
    computed/<owner>/<fingerprint>  which job has computed what
    outbox/<id>                     its webhook is still to be told
    batches/<id>.json               jobs that are asked about together
    gone/<id>                       the job was deleted; in it, whose it was
    doomed/<id>                     the job is being deleted; in it, its record
    secret                          from which the secrets of the installation are derived
    jobs/<id>/mesh-<sha256>         the bytes that the client sent
             /job.json              the record, written after everything else: the job is accepted
             /attempt-<n>.json
             /result.cleave         mesh and hierarchy
             /manifest.json         the outcome, written last and once: the job is finished

Only what is under ``jobs`` is the truth. The rest are hints, made before or removed after, so that after a crash
between two writes there is one too many, never one too few.
"""

from worker.jobs.job import Job, is_job_id

JOBS = "jobs"
RECORD = "job.json"
MANIFEST = "manifest.json"
RESULT = "result.cleave"
MESH = "mesh"  # in folders of earlier versions

TIME_FORMAT = "%Y%m%dT%H%M%S%f"  # UTC
NOBODY = "_"  # the folder of jobs without an owner; not the name of one


def job_folder(job_id: str) -> str:
    if not is_job_id(job_id):
        raise ValueError(f"Not the id of a job: {job_id!r}.")
    return f"{JOBS}/{job_id}"


def job_key(job_id: str, name: str) -> str:
    return f"{job_folder(job_id)}/{name}"


def mesh_name(job: Job) -> str:
    """Named by its content: two uploads for the same id do not overwrite each other."""
    return f"mesh-{job.sha256}"


def entry_name(job: Job) -> str:
    """Later for later jobs."""
    return f"{job.created_at:{TIME_FORMAT}}-{job.id}"
