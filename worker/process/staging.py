"""Staging: a local copy of a job for a child process that cannot use the storage itself.

Connections to a bucket live in threads, which a fork does not copy. The worker therefore downloads the mesh before the
fork, the child process finds the job in a store in a local folder, and the worker uploads the result after it ends.
"""

import logging
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path

from worker.jobs.job import Succeeded
from worker.jobs.objects.interface import StoreError
from worker.jobs.objects.local import LocalObjects
from worker.jobs.store.layout import RESULT, job_key, mesh_name
from worker.jobs.store.records import Records
from worker.jobs.store.spool import Spool
from worker.jobs.store.store import JobStore, UnknownJob

log = logging.getLogger("cleave.worker")

_PUBLISH_TIMEOUT_S = 60.0  # an outage of a minute must not cost the hours that a job may have run; set by hand
_RETRY_PAUSE_S = 1.0

DuringTransfer = Callable[[], AbstractContextManager[None]]


@dataclass(frozen=True, slots=True)
class StagedJob:
    """A job as a child process finds it, in which it leaves the outcome."""

    folder: Path | None  # of the copy; None if the child process uses the original store
    _job_id: str
    _origin: JobStore
    _during_transfer: DuringTransfer

    def publish(self) -> bool:
        """Copy the outcome, if there is one, to the original store, unless the job was deleted meanwhile.

        Return whether there was something to copy.

        Raises
        ------
        StoreError
            If the store does not answer for a minute.
        """
        if self.folder is None:
            return False
        with self._during_transfer():
            self._upload(self.folder)
        return True

    def _upload(self, folder: Path) -> None:
        outcome = staged_store(folder).records.outcome(self._job_id)
        if outcome is None:
            return
        gives_up_at = time.monotonic() + _PUBLISH_TIMEOUT_S
        while True:
            try:
                if isinstance(outcome, Succeeded):
                    self._origin.results.put(self._job_id, folder / job_key(self._job_id, RESULT))
                self._origin.finish(self._job_id, outcome)
                return
            except UnknownJob:
                return
            except StoreError as error:
                if time.monotonic() > gives_up_at:
                    raise
                log.warning("the outcome is not in the store yet: %s", error)
                time.sleep(_RETRY_PAUSE_S)


@contextmanager
def stage(store: JobStore, job_id: str, during_transfer: DuringTransfer) -> Iterator[StagedJob]:
    """Copy a job to this machine if the storage does not survive a fork; the copy is removed on exit.

    ``during_transfer`` is a context for the downloads and uploads, which may take long.

    Raises
    ------
    UnknownJob
        If the job was deleted.
    StoreError
        If the store does not answer.
    """
    if store.objects.survives_fork:
        yield StagedJob(None, job_id, store, during_transfer)
        return
    with store.spool.stage() as folder:
        with during_transfer():
            _download(store, job_id, folder)
        yield StagedJob(folder, job_id, store, during_transfer)


def staged_store(folder: Path) -> JobStore:
    """Return the store in the folder of a copy."""
    return JobStore(LocalObjects(folder), Spool(folder / "spool"))


def _download(store: JobStore, job_id: str, folder: Path) -> None:
    job = store.records.job(job_id)
    if job is None:
        raise UnknownJob(job_id)
    objects = LocalObjects(folder)
    copy = folder / "mesh"
    try:
        with store.open_mesh(job_id) as source, copy.open("xb") as target:
            shutil.copyfileobj(source, target)
        objects.put_file(job_key(job_id, mesh_name(job)), copy)
    except FileNotFoundError:
        log.error("the mesh is not in the store")  # the child process reports it to the client
    Records(objects).create_job(job)
