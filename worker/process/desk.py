"""A copy of one job on this machine, for a work-horse that cannot reach the store of the installation itself.

The connections to a bucket live in threads, which a fork does not copy. So the worker fetches the mesh, the work-horse
finds the job in a store of its own, a folder, and the worker takes over what it has left there.
"""

import logging
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from worker.jobs.job import Succeeded
from worker.jobs.objects.local import LocalObjects
from worker.jobs.objects.seam import StoreError
from worker.jobs.store.layout import RESULT, job_key, mesh_name
from worker.jobs.store.records import Records
from worker.jobs.store.spool import Spool
from worker.jobs.store.store import JobStore, UnknownJob

log = logging.getLogger("cleave.worker")

_PATIENCE_S = 60.0  # for a store that does not answer, before hours of work are given up
_PAUSE_S = 1.0


@dataclass(frozen=True, slots=True)
class Desk:
    """Where a work-horse finds a job and leaves its outcome."""

    store: JobStore  # for the work-horse
    _job_id: str
    _owner: JobStore  # the store of the installation
    _folder: Path | None  # None where the two are the same

    def publish(self) -> None:
        """Bring the outcome, where there is one, to the store of the installation; without effect after a deletion.

        Raises
        ------
        StoreError
            Where the store did not answer for a minute.
        """
        outcome = self.store.outcome(self._job_id) if self._folder else None
        if self._folder is None or outcome is None:
            return
        gives_up_at = time.monotonic() + _PATIENCE_S
        while True:
            try:
                if isinstance(outcome, Succeeded):
                    self._owner.put_result(self._job_id, self._folder / job_key(self._job_id, RESULT))
                self._owner.finish(self._job_id, outcome)
                return
            except UnknownJob:
                return
            except StoreError as error:
                if time.monotonic() > gives_up_at:
                    raise
                log.warning("the outcome is not in the store yet: %s", error)
                time.sleep(_PAUSE_S)


@contextmanager
def desk_for(store: JobStore, job_id: str) -> Iterator[Desk]:
    """A place to work on a job of a store; what was copied is removed afterwards.

    Raises
    ------
    UnknownJob
        Where the job was deleted.
    StoreError
        Where the store does not answer.
    """
    if store.is_local:
        yield Desk(store, job_id, store, None)
        return
    with store.spool.stage() as folder:
        yield Desk(_copy(store, job_id, folder), job_id, store, folder)


def _copy(store: JobStore, job_id: str, folder: Path) -> JobStore:
    job = store.job(job_id)
    if job is None:
        raise UnknownJob(job_id)
    objects = LocalObjects(folder)
    copy = folder / "mesh"
    try:
        with store.open_mesh(job_id) as source, copy.open("xb") as target:
            shutil.copyfileobj(source, target)
        objects.put_file(job_key(job_id, mesh_name(job)), copy)
    except FileNotFoundError:
        log.error("the mesh is not in the store")  # the work-horse says so to the client
    Records(objects).create_job(job)
    return JobStore(objects, Spool(folder / "spool"))
