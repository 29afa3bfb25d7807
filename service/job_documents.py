"""The JSON document of a job: a model for each status, so that types made from the OpenAPI document are exact."""

from datetime import datetime
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import BaseModel, Field, WithJsonSchema
from typing_extensions import TypeAliasType

from segcore.levels import one_segment_note
from segcore.parameters import USUAL_SEGMENTS
from segcore.progress import seconds_left
from segcore.report import MeshReport, structure_note
from service.answer.model_formats import model_links
from service.mount import public_path
from service.problems import JobError
from worker.jobs.attempts import Attempt
from worker.jobs.job import Canceled, Failed, Job, Outcome, Succeeded, now
from worker.jobs.queue.queue import Activity
from worker.process.progress import REPORTED_STAGES

Status: TypeAlias = Literal["queued", "running", "succeeded", "failed", "canceled"]
_MAX_SEGMENTS = "The largest possible number of segments."
_AUTOMATIC_SEGMENTS = "The number of segments if a request gives none."
Stage: TypeAlias = Annotated[str, WithJsonSchema({"type": "string", "enum": list(REPORTED_STAGES)})]


class InputDocument(BaseModel):
    """The uploaded mesh file."""

    file_name: str | None = Field(description="Its name at the client.", examples=["hand.off"])
    format: str | None = Field(
        description="Declared by its name or type; null if it is detected from the content.", examples=["off"]
    )
    size_bytes: int = Field(examples=[274_139])
    sha256: str = Field(description="Of its bytes, in hexadecimal.")


class MeshSummary(BaseModel):
    faces: int = Field(examples=[12_000])
    vertices: int = Field(examples=[6_002])
    report: MeshReport | None = Field(description="Properties of the mesh; null in jobs of earlier versions.")


class JobLinks(BaseModel):
    """Paths on this server; results are available when the job has succeeded."""

    self: str
    events: str
    cancel: str
    labels: str
    hierarchy: str
    model: str = Field(
        description="A coloured GLB; ?segments=k for another level, ?levels=all for all levels in one file."
    )
    ply: str
    obj: str
    mtl: str = Field(description="The colours of the OBJ file.")
    objzip: str = Field(description="A ZIP archive with the OBJ file and its colours.")
    threemf: str
    usdc: str = Field(description="USD, with subsets of faces for the parts of every level.")
    usdz: str
    parts: str = Field(description="A ZIP archive with a file per segment.")
    print: str = Field(description="3MF for printing: solids with connectors and filaments.")
    print_report: str = Field(description="What the file for printing contains.")
    robot: str = Field(description="A ZIP archive with URDF and MJCF: parts as links with masses.")
    robot_report: str = Field(description="What the robot consists of.")
    preview: str = Field(description="A picture.")
    edits: str = Field(description="For POST.")
    revisions: str


class _Job(BaseModel):
    """The fields of every job.

    The model of a status narrows those that are never null there. The others stay nullable rather than null, because
    openapi-fetch leaves out properties whose only value is null.
    """

    id: str = Field(examples=["5f1c5d1d2c0f4e0fa8f0b4b2f1a9d6c3"])
    status: Status
    stage: Stage | None = Field(description="Stage of a running job; null if it is not known.")
    progress: float = Field(ge=0, le=1, description="Fraction of the work that is done.")
    seconds_left: int | None = Field(
        ge=0,
        description="Estimated seconds until the end of a running job, from its progress so far. Null if the job does "
        "not run, in its first second, and if its progress is not known.",
        examples=[12],
    )
    queue_position: int | None = Field(description="Position of a waiting job: 1 is next. Null if it is not known.")
    waits_for: str | None = Field(
        description="What a waiting job waits for, apart from the jobs before it: `compiling, once: 14 of 52` at the "
        "first start of the service."
    )
    created_at: datetime
    started_at: datetime | None = Field(description="Start of the latest attempt.")
    finished_at: datetime | None
    attempts: int = Field(description="Number of times the job was started.")
    input: InputDocument
    parameters: dict[str, Any] = Field(description="All parameters of the segmentation, including defaults.")
    mesh: MeshSummary | None = Field(description="Null until the job has succeeded.")
    max_segments: int | None = Field(description=_MAX_SEGMENTS)
    automatic_segments: int | None = Field(description=_AUTOMATIC_SEGMENTS)
    limit_reached: bool | None = Field(
        description="Whether the hierarchy ends at max_segments because of the parameter of that name, although "
        "sensible cuts are left. Null if that is not known, as in jobs of earlier versions."
    )
    revision: int = Field(
        description="The newest revision of its parts; 0 if they were not edited. In a list of jobs that are stored in "
        "a bucket it may be an earlier one."
    )
    notes: list[str] = Field(
        description="Sentences on what limits the result, for people: for example that a file has more shells than "
        "segments can be, or that the automatic number is 1 although there are cuts."
    )
    error: JobError | None = Field(description="The reason why the job failed; null if it did not.")
    links: JobLinks


class QueuedJob(_Job):
    """A job that waits for a worker."""

    status: Literal["queued"]


class RunningJob(_Job):
    """A job that a worker runs."""

    status: Literal["running"]


class SucceededJob(_Job):
    """A job with a result."""

    status: Literal["succeeded"]
    finished_at: datetime
    mesh: MeshSummary
    max_segments: int = Field(description=_MAX_SEGMENTS)
    automatic_segments: int = Field(description=_AUTOMATIC_SEGMENTS)


class FailedJob(_Job):
    """A job that ended without a result."""

    status: Literal["failed"]
    finished_at: datetime
    error: JobError = Field(description="The reason why the job failed.")


class CanceledJob(_Job):
    """A job that its client has canceled."""

    status: Literal["canceled"]
    finished_at: datetime


class _Labels(BaseModel):
    segments: int | None = Field(description="The number of segments of these labels.")
    labels: list[int] | None = Field(
        description="The segment of every face, in the order of the file. Null unless the client waited for the job "
        "and it succeeded."
    )


class SubmittedSucceededJob(_Labels, SucceededJob):
    """A submitted job that has succeeded."""


class SubmittedFailedJob(_Labels, FailedJob):
    """A submitted job that has failed."""


class SubmittedCanceledJob(_Labels, CanceledJob):
    """A submitted job that was canceled while the client waited."""


_BY_STATUS = Field(discriminator="status")
JobDocument = TypeAliasType(
    "JobDocument", Annotated[QueuedJob | RunningJob | SucceededJob | FailedJob | CanceledJob, _BY_STATUS]
)
UnfinishedJobDocument = TypeAliasType("UnfinishedJobDocument", Annotated[QueuedJob | RunningJob, _BY_STATUS])
SubmittedJobDocument = TypeAliasType(
    "SubmittedJobDocument",
    Annotated[SubmittedSucceededJob | SubmittedFailedJob | SubmittedCanceledJob, _BY_STATUS],
)


class JobPageDocument(BaseModel):
    jobs: list[JobDocument] = Field(description="Newest first; may be fewer than the limit although more jobs follow.")
    next_cursor: str | None = Field(description="Send it as cursor to get the next page; null on the last page.")


def job_document(
    job: Job, outcome: Outcome | None, attempts: list[Attempt], activity: Activity | None, revision: int = 0
) -> JobDocument:
    """Return the document of a job; ``activity`` is None if the queue does not answer."""
    fields = _common_fields(job, attempts)
    match outcome:
        case Succeeded():
            return SucceededJob(**fields | _result_fields(job, outcome) | {"revision": revision})
        case Failed(finished_at=finished_at, code=code, message=message):
            error = JobError(code=code, message=message)
            return FailedJob(**fields | {"status": "failed", "finished_at": finished_at, "error": error})
        case Canceled(finished_at=finished_at):
            return CanceledJob(**fields | {"status": "canceled", "finished_at": finished_at})
    if not _is_running(attempts, activity):
        return QueuedJob(**fields | {"status": "queued"} | _waiting_fields(activity))
    progress = activity.progress if activity is not None else None
    shown: dict[str, Any] = {} if progress is None else {"stage": progress.stage, "progress": progress.fraction}
    if progress is not None and attempts:
        elapsed_s = (now() - attempts[-1].started_at).total_seconds()
        shown["seconds_left"] = seconds_left(elapsed_s, progress.fraction)
    return RunningJob(**fields | {"status": "running"} | shown)


def _waiting_fields(activity: Activity | None) -> dict[str, Any]:
    if activity is None:
        return {}
    reason = activity.compilation
    return {"queue_position": activity.position, "waits_for": None if reason is None else str(reason)}


def _common_fields(job: Job, attempts: list[Attempt]) -> dict[str, Any]:
    """Return the fields of a job that do not depend on its status, and the others as null."""
    return {
        **dict.fromkeys(_Job.model_fields),
        "id": job.id,
        "progress": 0.0,
        "created_at": job.created_at,
        "started_at": attempts[-1].started_at if attempts else None,
        "attempts": len(attempts),
        "input": InputDocument(
            file_name=job.file_name, format=job.mesh_format, size_bytes=job.size_bytes, sha256=job.sha256
        ),
        "parameters": job.parameters,
        "revision": 0,
        "notes": [],
        "links": job_links(public_path(f"/v1/jobs/{job.id}")),
    }


def _is_running(attempts: list[Attempt], activity: Activity | None) -> bool:
    if activity is not None:
        return activity.running
    return bool(attempts) and attempts[-1].ended_at is None


def _result_fields(job: Job, outcome: Succeeded) -> dict[str, Any]:
    mesh = MeshSummary.model_validate({"faces": outcome.faces, "vertices": outcome.vertices, "report": outcome.report})
    return {
        "status": "succeeded",
        "progress": 1.0,
        "finished_at": outcome.finished_at,
        "mesh": mesh,
        "max_segments": outcome.max_segments,
        "automatic_segments": outcome.automatic_segments,
        "limit_reached": outcome.limit_reached,
        "notes": _notes(job, outcome, mesh),
    }


def _notes(job: Job, outcome: Succeeded, mesh: MeshSummary) -> list[str]:
    notes = [one_segment_note(outcome.automatic_segments, outcome.max_segments)]
    counts = mesh.report.structure if mesh.report else None
    if counts is not None and "structure" in job.parameters:
        most = job.parameters["max_segments"] or USUAL_SEGMENTS
        notes.append(structure_note(counts, job.parameters["structure"], most))
    return [note for note in notes if note is not None]


def job_links(path: str) -> JobLinks:
    return JobLinks(
        self=path,
        events=f"{path}/events",
        cancel=f"{path}/cancel",
        labels=f"{path}/labels",
        hierarchy=f"{path}/hierarchy",
        print=f"{path}/print.3mf",
        print_report=f"{path}/print.json",
        robot=f"{path}/robot.zip",
        robot_report=f"{path}/robot.json",
        preview=f"{path}/preview.png",
        edits=f"{path}/edits",
        revisions=f"{path}/revisions",
        **model_links(path),
    )
