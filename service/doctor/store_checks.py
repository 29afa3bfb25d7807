"""Checks of the store and the data folder: access, clock, permissions and free space."""

import secrets
import shutil
import stat
import time
from collections.abc import Iterator
from pathlib import Path

from cleave.settings import InvalidSettings, Settings
from service.doctor.findings import Finding, error, ok, warning
from service.doctor.queue_checks import check_clock
from service.host.folders import can_be_made, nearest_existing
from worker.jobs.objects.interface import ObjectStorage
from worker.jobs.store.opening import open_store

_MIN_UPLOADS = 8  # of the largest size that a disk should have room for; set by hand


def check_store(settings: Settings) -> list[Finding]:
    """Check the store of the jobs, and the data folder of this machine."""
    return [*_store(settings), *_data_folder(settings.data_dir), *_disk(settings)]


def _store(settings: Settings) -> Iterator[Finding]:
    if settings.store_url is None and not settings.data_dir.exists():
        yield _future_folder(settings.data_dir)
        return
    try:
        store = open_store(settings)
        store.check_writable()
        ahead_s = _clock_ahead_s(store.objects)
    except (OSError, InvalidSettings) as problem:
        yield error(
            "store",
            f"it cannot be written: {str(problem).rstrip('.')}.",
            "Check CLEAVE_STORE_URL and its credentials, or the permissions of CLEAVE_DATA_DIR.",
        )
        return
    yield ok("store", "it can be written." if settings.store_url is None else "the bucket can be written.")
    yield check_clock("store's clock", ahead_s)


def _future_folder(data_dir: Path) -> Finding:
    """Check that a data folder can be made, without making it."""
    if can_be_made(data_dir):
        return ok("data folder", f"{data_dir} does not exist yet, and the first start can make it.")
    return error(
        "data folder",
        f"{data_dir} does not exist, and {nearest_existing(data_dir)} cannot be written.",
        "Make the folder for this user, or set CLEAVE_DATA_DIR.",
    )


def _clock_ahead_s(objects: ObjectStorage) -> float:
    """Return how far the clock that stamps objects is ahead of this one, to about a second."""
    folder = f"incoming/{secrets.token_hex(16)}"  # removed with its last object
    key = f"{folder}/probe"
    began_at = time.time()
    objects.put(key, b"?")
    try:
        stamped = [found.modified_at for found in objects.list_below(folder) if found.key == key]
    finally:
        objects.delete(key)
    return stamped[0] - (began_at + time.time()) / 2 if stamped else 0.0


def _data_folder(data_dir: Path) -> Iterator[Finding]:
    if not data_dir.exists():
        return
    mode = stat.S_IMODE(data_dir.stat().st_mode)
    if mode & 0o077:
        yield warning("data folder", f"other users of this machine can read {data_dir}.", f"chmod 700 {data_dir}")
    else:
        yield ok("data folder", f"only this user can read {data_dir}.")


def _disk(settings: Settings) -> Iterator[Finding]:
    existing = nearest_existing(settings.data_dir)
    free = shutil.disk_usage(existing).free
    text = f"{free / 2**30:.1f} GiB are free in {existing}"
    if free < settings.max_upload_bytes:
        yield error(
            "disk",
            f"{text}: less than the largest mesh that is accepted.",
            "Make room, set CLEAVE_RETENTION_S, or lower CLEAVE_MAX_UPLOAD_BYTES.",
        )
    elif free < _MIN_UPLOADS * settings.max_upload_bytes:
        yield warning("disk", f"{text}: a few of the largest meshes fill it.", "Make room, or set CLEAVE_RETENTION_S.")
    else:
        yield ok("disk", f"{text}.")
