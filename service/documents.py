"""Models of the JSON documents of the API except jobs, from which its OpenAPI document is made."""

from datetime import datetime
from typing import Literal

from pydantic import BaseModel, Field

from service.job_documents import Status
from service.problems import JobError, drop_default


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


class SaidPart(BaseModel):
    """What is said about a part of a revision."""

    name: str = Field(description="Empty for none.", examples=["left arm"])
    color: str | None = Field(description="Null for the colour of its number.", examples=["#56b4e9"])
    class_name: str = Field(serialization_alias="class", description="Empty for none.", examples=["limb"])
    locked: bool


class _SaidOfLabels(BaseModel):
    parts: list[SaidPart] = Field(
        default=[],
        description="Of a revision: what is said about the part of each label. Absent at a level.",
        json_schema_extra=drop_default,
    )
    classes: list[str] = Field(
        default=[],
        description="With by=class: the name of each number; 0 is for parts without a class. Else absent.",
        json_schema_extra=drop_default,
    )


class LabelsDocument(_SaidOfLabels):
    segments: int
    labels: list[int] = Field(description="The segment 0..segments-1 of every face, in the order of the file.")


class RunsDocument(_SaidOfLabels):
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
    keys_required: bool = Field(description="Whether requests for jobs need an API key.")
    version: str = Field(description="Of the software; results depend on it.")


class WebhookSecret(BaseModel):
    secret: str = Field(
        description="The signing secret, for any library of Standard Webhooks.",
        examples=["whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw"],
    )


class Health(BaseModel):
    status: Literal["ok"] = "ok"


class CompilationDocument(BaseModel):
    done: int = Field(description="Number of kernels that are compiled.", examples=[14])
    count: int = Field(description="Number of all that are needed for the first job.", examples=[52])


class Readiness(BaseModel):
    ready: bool
    queue: bool = Field(description="The queue server answers.")
    store: bool = Field(description="The store is writable.")
    workers: int = Field(description="Number of live workers.")
    missing: list[str] = Field(description="Reasons why the service is not ready, one sentence each.")
    compilation: CompilationDocument | None = Field(
        description="The compilation that the workers wait for, at the first start of the service."
    )
