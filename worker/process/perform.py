"""Runs a job: segments its mesh, and writes the result file and the outcome to the store."""

import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass

import segcore
from cleave.settings import Settings
from segcore.io import ReadLimits
from segcore.io.result import write_result
from segcore.threads import MANY_FACES
from worker.jobs.attempts import INPUT_LOST
from worker.jobs.job import Failed, Job, Outcome, Succeeded, now
from worker.jobs.store.store import JobStore, UnknownJob
from worker.process.progress import OnProgress, StageClock

log = logging.getLogger("cleave.work_horse")


@dataclass(frozen=True, slots=True)
class Work:
    """A job that this run has given its outcome, and the durations of the stages."""

    job: Job
    outcome: Outcome
    stage_seconds: dict[str, float]


def perform(
    store: JobStore,
    settings: Settings,
    job_id: str,
    on_progress: OnProgress,
    announce_end: Callable[[], None] = lambda: None,
) -> Work | None:
    """Give a job its outcome; return None if it has one already or was deleted.

    ``announce_end`` is called as soon as the outcome can be read.
    """
    job = store.records.job(job_id)
    if job is None or store.records.outcome(job_id) is not None:
        return None
    clock = StageClock(on_progress)
    try:
        outcome = segment_stored_mesh(store, job, read_limits(settings), clock, settings.job_threads)
        if store.finish(job_id, outcome, announce_end).finished_at != outcome.finished_at:
            log.info("the job has ended meanwhile: the outcome of this run is dropped")
            return None
    except UnknownJob:
        return None
    work = Work(job, outcome, clock.stop())
    log.info(outcome.status, extra={"fields": _fields(work)})
    return work


def _fields(work: Work) -> dict[str, object]:
    """What the one line of a job in the log says, apart from its id and how it ended."""
    job, outcome = work.job, work.outcome
    seconds = (outcome.finished_at - job.created_at).total_seconds()
    fields: dict[str, object] = {"owner": job.owner, "bytes": job.size_bytes, "seconds": round(seconds, 3)}
    if isinstance(outcome, Succeeded):
        fields |= {"faces": outcome.faces, "segments": outcome.automatic_segments}
    if isinstance(outcome, Failed):
        fields |= {"code": outcome.code}
    return fields | {"stage_seconds": {name: round(s, 4) for name, s in work.stage_seconds.items()}}


def segment_stored_mesh(
    store: JobStore, job: Job, limits: ReadLimits, clock: StageClock, threads: int | None = None
) -> Outcome:
    """Segment the mesh of a job and write its result file; expected errors are returned as Failed.

    A thread makes the report meanwhile, unless its memory would add to that of a large segmentation.
    """
    try:
        clock("reading", 0.0)
        with store.open_mesh(job.id) as source:
            mesh = segcore.read_mesh(source, job.mesh_format, limits=limits, appearance=True, unit=job.unit, up=job.up)
        clock("clean", 0.0)
        surface = segcore.build_surface(mesh)
        parameters = segcore.SegmentationParameters.from_mapping(job.parameters)
        with ThreadPoolExecutor(1) as beside:
            report = beside.submit(segcore.mesh_report, mesh, surface) if len(mesh.faces) < MANY_FACES else None
            hierarchy = segcore.segment(mesh, parameters, clock, surface, threads)
    except segcore.CleaveError as error:
        return Failed(finished_at=now(), code=error.code, message=str(error))
    except FileNotFoundError:
        return Failed(finished_at=now(), code=INPUT_LOST, message="The mesh is no longer in the store: send it again.")
    clock.begin("storing")
    store.results.write(job.id, lambda target: write_result(target, mesh, hierarchy))
    return Succeeded(
        finished_at=now(),
        faces=len(mesh.faces),
        vertices=len(mesh.vertices),
        max_segments=hierarchy.max_segments,
        automatic_segments=hierarchy.automatic_segments,
        limit_reached=hierarchy.limit_reached,
        report=asdict(report.result() if report else segcore.mesh_report(mesh, surface)),
    )


def read_limits(settings: Settings) -> ReadLimits:
    return ReadLimits(
        max_bytes=settings.max_upload_bytes,
        max_uncompressed_bytes=settings.max_uncompressed_bytes,
        max_faces=settings.max_faces,
        max_vertices=settings.max_vertices,
    )
