"""Models of the JSON documents of the API, from which its OpenAPI document is made."""

from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, Field

from segcore.levels import one_segment_note
from segcore.parameters import USUAL_SEGMENTS
from segcore.report import MeshReport, structure_note
from service.answer.model_formats import model_links
from service.mount import public_path
from service.problems import JobError
from worker.jobs.attempts import Attempt
from worker.jobs.job import Canceled, Failed, Job, Outcome, Succeeded
from worker.jobs.queue.queue import Activity
from worker.process.progress import REPORTED_STAGES

Status = Literal["queued", "running", "succeeded", "failed", "canceled"]


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
    parts: str = Field(description="A ZIP archive with a file per segment.")
    preview: str = Field(description="A picture.")


class JobDocument(BaseModel):
    id: str = Field(examples=["5f1c5d1d2c0f4e0fa8f0b4b2f1a9d6c3"])
    status: Status
    stage: str | None = Field(
        description=f"Stage of a running job: one of {', '.join(REPORTED_STAGES)}.", examples=["cut"]
    )
    progress: float = Field(ge=0, le=1, description="Fraction of the work that is done.")
    queue_position: int | None = Field(description="Position of a waiting job: 1 is next. Null if it is not known.")
    created_at: datetime
    started_at: datetime | None = Field(description="Start of the latest attempt.")
    finished_at: datetime | None
    attempts: int = Field(description="Number of times the job was started.")
    input: InputDocument
    parameters: dict[str, Any] = Field(description="All parameters of the segmentation, including defaults.")
    mesh: MeshSummary | None = Field(description="Null until the job has succeeded.")
    max_segments: int | None = Field(description="The largest possible number of segments.")
    automatic_segments: int | None = Field(description="The number of segments if a request gives none.")
    limit_reached: bool | None = Field(
        description="Whether the hierarchy ends at max_segments because of the parameter of that name, although "
        "sensible cuts are left. Null if that is not known, as in jobs of earlier versions."
    )
    notes: list[str] = Field(
        description="Sentences on what limits the result, for people: for example that a file has more shells than "
        "segments can be, or that the automatic number is 1 although there are cuts."
    )
    error: JobError | None = Field(description="The reason why the job failed.")
    links: JobLinks


class JobPageDocument(BaseModel):
    jobs: list[JobDocument] = Field(description="Newest first; may be fewer than the limit although more jobs follow.")
    next_cursor: str | None = Field(description="Send it as cursor to get the next page; null on the last page.")


class SubmittedJobDocument(JobDocument):
    """A submitted job, with its labels if the client waited for it and it succeeded."""

    segments: int | None = Field(description="The number of segments of these labels.")
    labels: list[int] | None = Field(description="The segment of every face, in the order of the file.")


class BatchJobs(BaseModel):
    """Jobs to be combined into a batch."""

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
    results: str = Field(description="A ZIP archive, available when the batch is finished.")


class BatchDocument(BaseModel):
    id: str
    status: Literal["running", "finished"] = Field(description="Finished when every job has ended, with any status.")
    created_at: datetime
    counts: dict[str, int] = Field(description="Jobs by status.", examples=[{"succeeded": 98, "running": 2}])
    jobs: list[BatchedJob] = Field(description="In the order of the request.")
    left_out: list[str] = Field(description="Files of the request that are no meshes, and to which none refers.")
    links: BatchLinks


class LabelsDocument(BaseModel):
    segments: int
    labels: list[int] = Field(description="The segment 0..segments-1 of every face, in the order of the file.")


class RunsDocument(BaseModel):
    """Labels in run-length form: the first lengths[0] faces have the label values[0], and so on."""

    segments: int
    faces: int
    values: list[int]
    lengths: list[int]


class HierarchyNode(BaseModel):
    """A segment of some levels. Node 0 is the whole mesh."""

    id: int
    parent: int | None
    children: list[int] = Field(description="Two nodes, the larger one first, or none.")
    level: int = Field(description="The smallest number of segments at which the node is a segment.")
    label: int = Field(description="Its label at every level at which it is a segment.")
    area: float = Field(description="In squared units of the mesh.")
    faces: int
    cut_value: float | None = Field(description="Of the cut that splits the node; null for a leaf.")
    step: int | None = Field(description="Of the cut that splits the node; null for a leaf.")
    nary_children: list[int] = Field(
        description="Its children in the n-ary tree from node 0, in which equal parts are siblings: the nodes just "
        "below the cuts of its step. Empty for a leaf and for a node inside a step, which the n-ary tree leaves out."
    )


class CurvePoint(BaseModel):
    """The cost of one more segment."""

    segments: int = Field(description="The number of segments after the cut, 2 or more.")
    cut_value: float | None = Field(
        description="Normalized cut times the square root of the surface area: low at the end of a part, 0 between "
        "components, high if the cut is arbitrary."
    )
    node: int = Field(description="The node that is split.")
    step: int = Field(description="The step of the cut.")


class HierarchyDocument(BaseModel):
    max_segments: int
    automatic_segments: int
    limit_reached: bool | None = Field(
        description="Whether the hierarchy ends because of the parameter max_segments, although sensible cuts are "
        "left; null if that is not known."
    )
    steps: list[int] = Field(
        description="The step of each cut. Cuts that part equal things, such as the legs of a table, have one step."
    )
    step_ends: list[int] = Field(
        description="The numbers of segments that are worth offering: 1, and those after the last cut of each step."
    )
    cut_values: list[float | None] = Field(description="Entry i belongs to the cut from i + 1 to i + 2 segments.")
    curve: list[CurvePoint] = Field(description="The same by number of segments: cuts after a jump are arbitrary.")
    nodes: list[HierarchyNode]


class FormatDocument(BaseModel):
    name: str = Field(description="The value of ?format=.", examples=["stl"])
    title: str = Field(examples=["STL"])
    extensions: list[str]
    media_types: list[str] = Field(description="Possible values of Content-Type, the usual one first.")


class FormatsDocument(BaseModel):
    meshes: list[FormatDocument] = Field(description="Formats of uploads, also compressed with gzip.")
    labels: list[FormatDocument] = Field(description="Formats of labels.")
    models: list[FormatDocument] = Field(description="Formats of the segmented mesh.")
    max_upload_bytes: int
    max_faces: int
    version: str = Field(description="Of the software; results depend on it.")


class WebhookSecret(BaseModel):
    secret: str = Field(
        description="The signing secret, for any library of Standard Webhooks.",
        examples=["whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw"],
    )


class Health(BaseModel):
    status: Literal["ok"] = "ok"


class Readiness(BaseModel):
    ready: bool
    queue: bool = Field(description="The queue server answers.")
    store: bool = Field(description="The store is writable.")
    workers: int = Field(description="Number of live workers.")
    missing: list[str] = Field(description="Reasons why the service is not ready, one sentence each.")


def job_document(job: Job, outcome: Outcome | None, attempts: list[Attempt], activity: Activity | None) -> JobDocument:
    """Return the document of a job; ``activity`` is None if the queue does not answer."""
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
        links=_links(public_path(f"/v1/jobs/{job.id}")),
        **_result_fields(job, outcome),
    )


def _is_running(attempts: list[Attempt], activity: Activity | None) -> bool:
    if activity is not None:
        return activity.running
    return bool(attempts) and attempts[-1].ended_at is None


def _result_fields(job: Job, outcome: Outcome | None) -> dict[str, Any]:
    levels = ("max_segments", "automatic_segments", "limit_reached")
    fields: dict[str, Any] = {**dict.fromkeys(("mesh", *levels, "error")), "notes": []}
    match outcome:
        case Succeeded(faces=faces, vertices=vertices, report=report):
            mesh = MeshSummary.model_validate({"faces": faces, "vertices": vertices, "report": report})
            numbers = {name: getattr(outcome, name) for name in levels}
            return fields | numbers | {"mesh": mesh, "notes": _notes(job, outcome, mesh)}
        case Failed(code=code, message=message):
            return fields | {"error": JobError(code=code, message=message)}
        case Canceled() | None:
            return fields


def _notes(job: Job, outcome: Succeeded, mesh: MeshSummary) -> list[str]:
    notes = [one_segment_note(outcome.automatic_segments, outcome.max_segments)]
    counts = mesh.report.structure if mesh.report else None
    if counts is not None and "structure" in job.parameters:
        most = job.parameters["max_segments"] or USUAL_SEGMENTS
        notes.append(structure_note(counts, job.parameters["structure"], most))
    return [note for note in notes if note is not None]


def _links(path: str) -> JobLinks:
    return JobLinks(
        self=path,
        events=f"{path}/events",
        cancel=f"{path}/cancel",
        labels=f"{path}/labels",
        hierarchy=f"{path}/hierarchy",
        preview=f"{path}/preview.png",
        **model_links(path),
    )
