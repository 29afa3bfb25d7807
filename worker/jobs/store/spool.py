"""The spool: files of this machine that are written here before they are moved into the store.

<spool>/<random>/mesh          an upload
<spool>/<id>-<random>.result   the result of a running job
<spool>/stage-<random>/        the local copy of a running job of a bucket, locked while it runs
"""

import fcntl
import os
import secrets
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from worker.jobs.job import new_job_id
from worker.jobs.store.upload import MeshUpload


class Spool:
    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)

    def begin_upload(self) -> MeshUpload:
        return MeshUpload(self.folder / new_job_id())

    def result_file(self, job_id: str) -> Path:
        """Return a new path for the result of a job."""
        return self.folder / f"{job_id}-{secrets.token_hex(8)}.result"

    def remove_results(self, job_id: str) -> None:
        """Remove the incomplete results of killed runs of a job."""
        for torn in self.folder.glob(f"{job_id}-*.result"):
            torn.unlink(missing_ok=True)

    @contextmanager
    def stage(self) -> Iterator[Path]:
        """Provide a locked folder, which is removed on exit, or by the janitor if the process is killed."""
        folder = self.folder / f"stage-{secrets.token_hex(16)}"
        folder.mkdir(mode=0o700)
        lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX)
            yield folder
        finally:
            os.close(lock)
            shutil.rmtree(folder, ignore_errors=True)

    def remove_abandoned(self, untouched_s: float) -> None:
        """Remove files that have not been modified for a time, as their processes have died."""
        oldest = time.time() - untouched_s
        for path in self.folder.iterdir():
            if max((_modified_at(one) for one in (path, *path.glob("*"))), default=0.0) < oldest:
                _remove(path)


def _remove(path: Path) -> None:
    """Remove a file, or a folder that is not locked."""
    if not path.is_dir():
        path.unlink(missing_ok=True)
    elif not _is_locked(path):
        shutil.rmtree(path, ignore_errors=True)


def _is_locked(folder: Path) -> bool:
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    except FileNotFoundError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False


def _modified_at(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except FileNotFoundError:
        return 0.0
