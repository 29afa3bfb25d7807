"""Meshes and jobs for the tests of store, queue and workers."""

import numpy as np

from helpers.files.written import mesh_bytes
from segcore.mesh import Mesh
from worker.jobs.job import Job, new_job_id, now
from worker.jobs.size_class import SizeClass
from worker.jobs.store.store import JobStore

SMALL, LARGE = SizeClass
LONG = {"clusters": 20_000, "max_segments": 400}  # with sphere(100), seconds of work


def sphere(rows: int, bumps: float = 0.25) -> bytes:
    """Return an OFF file of a closed bumpy surface with 4 rows (rows - 1) faces."""
    columns = 2 * rows
    polar, azimuth = np.meshgrid(
        np.pi * np.arange(1, rows) / rows, 2 * np.pi * np.arange(columns) / columns, indexing="ij"
    )
    radius = 1 + bumps * np.sin(4 * polar) * np.cos(3 * azimuth)
    ring = np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=-1)
    vertices = np.vstack([(radius[..., None] * ring).reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    index = np.arange((rows - 1) * columns).reshape(rows - 1, columns)
    upper, lower, following = index[:-1], index[1:], np.roll(index, -1, axis=1)
    north, south = len(vertices) - 2, len(vertices) - 1
    faces = np.vstack(
        [
            np.stack([upper, lower, following[1:]], axis=-1).reshape(-1, 3),
            np.stack([upper, following[1:], following[:-1]], axis=-1).reshape(-1, 3),
            np.stack([np.full(columns, north), index[0], following[0]], axis=-1),
            np.stack([np.full(columns, south), following[-1], index[-1]], axis=-1),
        ]
    )
    return mesh_bytes(Mesh(vertices.round(6), faces), "off")


def accepted(store: JobStore, mesh: bytes, owner: str | None = None, **parameters: object) -> Job:
    """Put a job in a store, as the service does when it accepts a request."""
    with store.spool.begin_upload() as upload:
        upload.write(mesh)
        job = Job(
            id=new_job_id(),
            sha256=upload.sha256,
            size_bytes=upload.size_bytes,
            mesh_format=None,
            parameters=dict(parameters),
            created_at=now(),
            owner=owner,
        )
        store.accept(job, upload)
    return job


def unfinished(store: JobStore) -> dict[str, str | None]:
    """Return the unfinished jobs of a store and their owners, oldest first, and remove markers too many."""
    return {marker.job_id: marker.owner for marker in store.pending.unfinished(store.pending.markers())}
