"""The work itself: a mesh from the store becomes a result file in the store, and the job gets its outcome."""

from collections.abc import Callable
from dataclasses import asdict

import segcore
from segcore.io import ReadLimits
from segcore.io.result import write_result
from segcore.report import mesh_report
from segcore.surface import build_surface
from worker.jobs import Failed, Job, Outcome, Succeeded, now
from worker.settings import Settings
from worker.store import JobStore, UnknownJob

OnProgress = Callable[[str, float], None]


def perform(store: JobStore, settings: Settings, job_id: str, on_progress: OnProgress) -> None:
    """Bring a job to its outcome; without effect where it has one or was deleted."""
    job = store.job(job_id)
    if job is None or store.outcome(job_id) is not None:
        return
    try:
        store.finish(job_id, segment_stored_mesh(store, job, read_limits(settings), on_progress))
    except UnknownJob:
        return


def segment_stored_mesh(store: JobStore, job: Job, limits: ReadLimits, on_progress: OnProgress) -> Outcome:
    """Read, segment, write the result file: what was expected to go wrong is a value, the rest is raised."""
    try:
        on_progress("reading", 0.0)
        with store.open_mesh(job.id) as source:
            mesh = segcore.read_mesh(source, job.mesh_format, limits=limits, appearance=True)
        surface = build_surface(mesh)
        parameters = segcore.SegmentationParameters.from_mapping(job.parameters)
        hierarchy = segcore.segment(mesh, parameters, on_progress, surface)
    except segcore.CleaveError as error:
        return Failed(finished_at=now(), code=error.code, message=str(error))
    except FileNotFoundError:
        return Failed(
            finished_at=now(), code="input_lost", message="The mesh is no longer in the store: send it again."
        )
    store.write_result(job.id, lambda target: write_result(target, mesh, hierarchy))
    return Succeeded(
        finished_at=now(),
        faces=len(mesh.faces),
        vertices=len(mesh.vertices),
        max_segments=hierarchy.max_segments,
        automatic_segments=hierarchy.automatic_segments,
        report=asdict(mesh_report(mesh, surface)),
    )


def read_limits(settings: Settings) -> ReadLimits:
    return ReadLimits(max_bytes=settings.max_upload_bytes, max_faces=settings.max_faces)
