"""The names of the objects in a store.

    pending/<time>-<id>[.<owner>]   empty: the job has no outcome yet; made before the job is accepted
    index/<owner>/<time>-<id>       empty: the job exists; for lists of jobs
    computed/<owner>/<fingerprint>/<id>  empty: the job has succeeded with this input
    outbox/<id>                     the state of the delivery of its webhook
    edits/<edit>                    the edit waits in the queue; contains the id of its job
    batches/<id>.json               the jobs of a batch
    gone/<id>                       the job was deleted; contains its owner
    doomed/<id>                     the job is being deleted; contains its record
    secret                          of the installation
    jobs/<id>/mesh-<sha256>         the bytes of the request
             /job.json              the record, written after everything else: the job is accepted
             /attempt-<n>.json
             /result.cleave         mesh and hierarchy; jobs with the same input share its bytes in a folder
             /manifest.json         the outcome, written last and once: the job is finished
             /edits/<edit>.json     an edit that waits, or has waited, in the queue; .run-<n>, .ended: its outcome
             /revisions/<c>         the parts after an edit; c is the complement of the number 1, 2, ... of the revision

Only the objects under ``jobs`` count. The others are indexes: they are written before a job and removed after it, so a
crash between two writes leaves an entry without a job, never a job without an entry.
"""

from worker.jobs.job import Job, is_job_id

JOBS = "jobs"
DELETED = "gone"
BEING_DELETED = "doomed"
RECORD = "job.json"
MANIFEST = "manifest.json"
RESULT = "result.cleave"
REVISIONS = "revisions"
QUEUED_EDITS = "edits"
MESH = "mesh"  # in folders of earlier versions

_DIGITS = 8
_LAST_REVISION = 99_999_999  # the complement of 0

TIME_FORMAT = "%Y%m%dT%H%M%S%f"  # UTC
NO_OWNER = "_"  # the folder of jobs without an owner; no API key can have this name


def job_folder(job_id: str) -> str:
    if not is_job_id(job_id):
        raise ValueError(f"Not the id of a job: {job_id!r}.")
    return f"{JOBS}/{job_id}"


def job_key(job_id: str, name: str) -> str:
    return f"{job_folder(job_id)}/{name}"


def mesh_name(job: Job) -> str:
    """Return a name with the hash of the content, so that two uploads for one id do not overwrite each other."""
    return f"mesh-{job.sha256}"


def entry_name(job: Job) -> str:
    """Return a name that sorts by the time of acceptance."""
    return f"{job.created_at:{TIME_FORMAT}}-{job.id}"


def is_revision_number(number: int) -> bool:
    return 0 < number < _LAST_REVISION


def revision_key(job_id: str, number: int) -> str:
    """Return a key with the complement of the number, so that a list begins with the newest revision."""
    return job_key(job_id, f"{REVISIONS}/{_LAST_REVISION - number:0{_DIGITS}}")


def revision_number(key: str) -> int:
    return _LAST_REVISION - int(key[-_DIGITS:])
