"""What the service answers, as types: the OpenAPI document is made of them."""

from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, Field

from segcore.report import MeshReport
from service.problems import JobError
from worker.jobs.attempts import Attempt
from worker.jobs.job import Canceled, Failed, Job, Outcome, Succeeded
from worker.jobs.queue.queue import Activity

Status = Literal["queued", "running", "succeeded", "failed", "canceled"]


class InputDocument(BaseModel):
    """The file that was sent."""

    file_name: str | None = Field(description="What the client calls it.", examples=["hand.off"])
    format: str | None = Field(description="What its name or type says; null: told from its content.", examples=["off"])
    size_bytes: int = Field(examples=[274_139])
    sha256: str = Field(description="Of its bytes, in hexadecimal.")


class MeshSummary(BaseModel):
    faces: int = Field(examples=[12_000])
    vertices: int = Field(examples=[6_002])
    report: MeshReport | None = Field(description="What was found in the mesh; null in jobs of earlier versions.")


class JobLinks(BaseModel):
    """Paths on this server; those of the results answer once the job has succeeded."""

    self: str
    events: str
    cancel: str
    labels: str
    hierarchy: str
    model: str = Field(description="A coloured GLB; ?segments=k for another level, ?levels=all for all in one file.")
    ply: str
    obj: str
    threemf: str
    parts: str = Field(description="A ZIP archive with a file per segment.")
    preview: str = Field(description="A picture.")


class JobDocument(BaseModel):
    id: str = Field(examples=["5f1c5d1d2c0f4e0fa8f0b4b2f1a9d6c3"])
    status: Status
    stage: str | None = Field(description="What a running job is doing.", examples=["cut"])
    progress: float = Field(ge=0, le=1, description="The part of the work that is done.")
    queue_position: int | None = Field(description="Of a job that waits: 1 is next. Null where it is not known.")
    created_at: datetime
    started_at: datetime | None = Field(description="When the latest attempt began.")
    finished_at: datetime | None
    attempts: int = Field(description="How often the job was begun.")
    input: InputDocument
    parameters: dict[str, Any] = Field(description="Every parameter of the segmentation, defaults included.")
    mesh: MeshSummary | None = Field(description="Known when the job has succeeded.")
    max_segments: int | None = Field(description="The largest number of segments that can be asked for.")
    automatic_segments: int | None = Field(description="The number of segments where none is asked for.")
    error: JobError | None = Field(description="Why the job failed.")
    links: JobLinks


class JobPageDocument(BaseModel):
    jobs: list[JobDocument] = Field(description="Newest first; may be fewer than asked for while there are more.")
    next_cursor: str | None = Field(description="To be sent as cursor for the jobs that follow; null at the end.")


class SubmittedJobDocument(JobDocument):
    """A job as it was submitted; with its labels where the client waited for it and it succeeded."""

    segments: int | None = Field(description="The number of segments of these labels.")
    labels: list[int] | None = Field(description="For every face, in the order of the file, its segment.")


class BatchJobs(BaseModel):
    """Jobs that are to be a batch."""

    jobs: list[str] = Field(min_length=1, description="Ids of jobs.")


class BatchedJob(BaseModel):
    id: str
    file_name: str | None
    status: Status | Literal["deleted"]
    progress: float
    error: JobError | None
    self: str = Field(description="The path of the job.")


class BatchLinks(BaseModel):
    self: str
    results: str = Field(description="A ZIP archive, when the batch is finished.")


class BatchDocument(BaseModel):
    id: str
    status: Literal["running", "finished"] = Field(description="Finished when every job has ended, however.")
    created_at: datetime
    counts: dict[str, int] = Field(description="Jobs by status.", examples=[{"succeeded": 98, "running": 2}])
    jobs: list[BatchedJob] = Field(description="In the order in which they were sent.")
    links: BatchLinks


class LabelsDocument(BaseModel):
    segments: int
    labels: list[int] = Field(description="For every face, in the order of the file, its segment 0..segments-1.")


class RunsDocument(BaseModel):
    """Labels in run-length form: the first lengths[0] faces have the label values[0], and so on."""

    segments: int
    faces: int
    values: list[int]
    lengths: list[int]


class HierarchyNode(BaseModel):
    """A segment at some level. Node 0 is the whole mesh."""

    id: int
    parent: int | None
    children: list[int] = Field(description="Two, the larger first, or none.")
    level: int = Field(description="The smallest number of segments at which the node is a segment.")
    label: int = Field(description="Its label wherever it is a segment.")
    area: float = Field(description="In squared units of the mesh.")
    faces: int
    cut_value: float | None = Field(description="Of the cut that splits the node; null for a leaf.")


class CurvePoint(BaseModel):
    """What one segment more costs."""

    segments: int = Field(description="The number of segments that the cut leads to, 2 or more.")
    cut_value: float | None = Field(
        description="Normalized cut times the square root of the surface area: low where a part ends, 0 where "
        "components part, high where the cut is arbitrary."
    )
    node: int = Field(description="The node that is cut.")


class HierarchyDocument(BaseModel):
    max_segments: int
    automatic_segments: int
    cut_values: list[float | None] = Field(description="Entry i is of the cut from i + 1 to i + 2 segments.")
    curve: list[CurvePoint] = Field(description="The same, by number of segments: where it jumps, cuts get arbitrary.")
    nodes: list[HierarchyNode]


class FormatDocument(BaseModel):
    name: str = Field(description="As in ?format=.", examples=["stl"])
    title: str = Field(examples=["STL"])
    extensions: list[str]
    media_types: list[str] = Field(description="Those that a Content-Type may say; the usual one first.")


class FormatsDocument(BaseModel):
    meshes: list[FormatDocument] = Field(description="What can be sent, also compressed with gzip.")
    labels: list[FormatDocument] = Field(description="What labels can be fetched as.")
    models: list[FormatDocument] = Field(description="What the segmented mesh can be fetched as.")
    max_upload_bytes: int
    max_faces: int


class WebhookSecret(BaseModel):
    secret: str = Field(
        description="For any library of Standard Webhooks.", examples=["whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw"]
    )


class Health(BaseModel):
    status: Literal["ok"] = "ok"


class Readiness(BaseModel):
    ready: bool
    queue: bool = Field(description="The queue server answers.")
    store: bool = Field(description="The store can be written.")
    workers: int = Field(description="Workers that are alive.")
    missing: list[str] = Field(description="What keeps the service from being ready, in sentences.")


def job_document(job: Job, outcome: Outcome | None, attempts: list[Attempt], activity: Activity | None) -> JobDocument:
    """What clients are told about a job; ``activity`` is None where the queue does not answer."""
    is_running = outcome is None and _is_running(attempts, activity)
    progress = activity.progress if activity is not None and is_running else None
    return JobDocument(
        id=job.id,
        status=outcome.status if outcome else "running" if is_running else "queued",
        stage=progress.stage if progress else None,
        progress=1.0 if isinstance(outcome, Succeeded) else progress.fraction if progress else 0.0,
        queue_position=None if outcome or activity is None else activity.position,
        created_at=job.created_at,
        started_at=attempts[-1].started_at if attempts else None,
        finished_at=outcome.finished_at if outcome else None,
        attempts=len(attempts),
        input=InputDocument(
            file_name=job.file_name, format=job.mesh_format, size_bytes=job.size_bytes, sha256=job.sha256
        ),
        parameters=job.parameters,
        links=_links(job.id),
        **_result_fields(outcome),
    )


def _is_running(attempts: list[Attempt], activity: Activity | None) -> bool:
    if activity is not None:
        return activity.running
    return bool(attempts) and attempts[-1].ended_at is None


def _result_fields(outcome: Outcome | None) -> dict[str, Any]:
    fields: dict[str, Any] = {"mesh": None, "max_segments": None, "automatic_segments": None, "error": None}
    match outcome:
        case Succeeded(faces=faces, vertices=vertices, max_segments=most, automatic_segments=automatic, report=report):
            mesh = MeshSummary.model_validate({"faces": faces, "vertices": vertices, "report": report})
            return fields | {"mesh": mesh, "max_segments": most, "automatic_segments": automatic}
        case Failed(code=code, message=message):
            return fields | {"error": JobError(code=code, message=message)}
        case Canceled() | None:
            return fields


def _links(job_id: str) -> JobLinks:
    path = f"/v1/jobs/{job_id}"
    return JobLinks(
        self=path,
        events=f"{path}/events",
        cancel=f"{path}/cancel",
        labels=f"{path}/labels",
        hierarchy=f"{path}/hierarchy",
        model=f"{path}/model.glb",
        ply=f"{path}/model.ply",
        obj=f"{path}/model.obj",
        threemf=f"{path}/model.3mf",
        parts=f"{path}/parts.zip",
        preview=f"{path}/preview.png",
    )
