"""Files of this machine that are on their way into the store.

<spool>/<random>/mesh          an upload
<spool>/<id>-<random>.result   what a running job writes
<spool>/stage-<random>/        a running job that was fetched from another machine, locked while it runs
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
        """A new place for the result of a job."""
        return self.folder / f"{job_id}-{secrets.token_hex(8)}.result"

    def remove_results(self, job_id: str) -> None:
        """Remove what killed runs of a job were writing."""
        for torn in self.folder.glob(f"{job_id}-*.result"):
            torn.unlink(missing_ok=True)

    @contextmanager
    def stage(self) -> Iterator[Path]:
        """A folder that is there as long as this process wants, and no longer than it lives and for an hour."""
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
        """Remove what processes left behind that died while they wrote."""
        oldest = time.time() - untouched_s
        for path in self.folder.iterdir():
            if max((_modified_at(one) for one in (path, *path.glob("*"))), default=0.0) < oldest:
                _remove(path)


def _remove(path: Path) -> None:
    """Remove a file, or a folder that nobody has locked."""
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
