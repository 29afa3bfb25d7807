"""The names of the objects in a store.

    pending/<time>-<id>[.<owner>]   empty: the job has no outcome yet; made before the job is accepted
    timeline/<owner>/<day>/<minute>/<time>-<id>   empty: the job exists; for lists of jobs
    ended/<day>/<minute>/<time>-<id>-<bytes>      empty: the job has an outcome since then; for retention
    computed/<owner>/<fingerprint>/<id>  empty: the job has succeeded with this input
    outbox/<id>                     the state of the delivery of its webhook
    edits/<edit>                    the edit waits in the queue; contains the id of its job
    batches/<id>.json               the jobs of a batch
    deleted/<3 digits>/<id>         the job was deleted; contains its owner
    doomed/<id>                     the job is being deleted; contains its record
    secret                          of the installation
    layout                          the version of these names; absent until objects with older ones are migrated
    jobs/<id>/mesh-<sha256>         the bytes of the request
             /job.json              the record, written after everything else: the job is accepted
             /attempt-<n>.json
             /result.cleave         mesh and hierarchy; jobs with the same input share its bytes in a folder
             /manifest.json         the outcome, written last and once: the job is finished
             /edits/<edit>.json     an edit that waits, or has waited, in the queue; .run-<n>, .ended: its outcome
             /revisions/<c>         the parts after an edit; c is the complement of the number 1, 2, ... of the revision

Only the objects under ``jobs`` count. The others are indexes: they are written before a job and removed after it, so a
crash between two writes leaves an entry without a job, never a job without an entry. An entry under ``ended`` is
written after the outcome and before the marker under ``pending`` is removed, and a check of the marker writes it again.

No operation lists a folder whose number of entries grows with the number of stored jobs. Names that are listed in
order of time are therefore in a folder per day and minute.
"""

from worker.jobs.job import Job, is_job_id
from worker.jobs.objects.interface import ObjectStorage

JOBS = "jobs"
TIMELINE = "timeline"
ENDED = "ended"
DELETED = "deleted"
BEING_DELETED = "doomed"
RECORD = "job.json"
MANIFEST = "manifest.json"
RESULT = "result.cleave"
REVISIONS = "revisions"
QUEUED_EDITS = "edits"
_VERSION_KEY, _CURRENT = "layout", b"2"
MESH = "mesh"  # in folders of earlier versions

_DIGITS = 8
_LAST_REVISION = 99_999_999  # the complement of 0

TIME_FORMAT = "%Y%m%dT%H%M%S%f"  # UTC
TIME_LENGTH = 21
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


def in_time_folders(name: str) -> str:
    """Return the path of a name that begins with a time: a folder for the day, one for the minute, and the name."""
    return f"{name[:8]}/{name[9:13]}/{name}"


def is_revision_number(number: int) -> bool:
    return 0 < number < _LAST_REVISION


def revision_key(job_id: str, number: int) -> str:
    """Return a key with the complement of the number, so that a list begins with the newest revision."""
    return job_key(job_id, f"{REVISIONS}/{_LAST_REVISION - number:0{_DIGITS}}")


def revision_number(key: str) -> int:
    return _LAST_REVISION - int(key[-_DIGITS:])


class LayoutVersion:
    """Whether objects with the names of earlier versions may be left in a store."""

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects
        self._is_current = False

    def is_current(self) -> bool:
        """Whether every object has one of the names above; this is final once it is true."""
        self._is_current = self._is_current or self._objects.get(_VERSION_KEY) == _CURRENT
        return self._is_current

    def make_current(self) -> None:
        self._objects.put(_VERSION_KEY, _CURRENT)
