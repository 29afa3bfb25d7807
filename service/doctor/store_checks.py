"""The store: whether it takes what it is given, has room for more, and keeps it to itself."""

import secrets
import shutil
import stat
import time
from collections.abc import Iterator
from pathlib import Path

from cleave.settings import InvalidSettings, Settings
from service.doctor.findings import Finding, error, ok, warning
from service.doctor.queue_checks import check_clock
from worker.jobs.objects.interface import ObjectStorage
from worker.jobs.store.opening import open_store

_PROBES = "probe"
_UPLOADS_LEFT = 8  # that a disk has room for before somebody should look at it


def check_store(settings: Settings) -> list[Finding]:
    """The place of the jobs, and the data folder of this machine."""
    return [*_place(settings), *_folder(settings.data_dir), *_room(settings)]


def _place(settings: Settings) -> Iterator[Finding]:
    try:
        store = open_store(settings)
        store.check_writable()
        ahead_s = _clock_ahead_s(store.objects)
    except (OSError, InvalidSettings) as problem:
        yield error(
            "store",
            f"it cannot be written: {str(problem).rstrip('.')}.",
            "Check CLEAVE_STORE_URL and its credentials, or the rights to CLEAVE_DATA_DIR.",
        )
        return
    yield ok("store", "it can be written." if settings.store_url is None else "the bucket can be written.")
    yield check_clock("store's clock", ahead_s)


def _clock_ahead_s(objects: ObjectStorage) -> float:
    """How far the clock is ahead that stamps the objects, to a second or so."""
    key = f"{_PROBES}/{secrets.token_hex(16)}"
    began_at = time.time()
    objects.put(key, b"?")
    try:
        stamped = [found.modified_at for found in objects.list_below(_PROBES) if found.key == key]
    finally:
        objects.delete(key)
    return stamped[0] - (began_at + time.time()) / 2 if stamped else 0.0


def _folder(data_dir: Path) -> Iterator[Finding]:
    if not data_dir.exists():
        return
    mode = stat.S_IMODE(data_dir.stat().st_mode)
    if mode & 0o077:
        yield warning("data folder", f"other users of this machine can look into {data_dir}.", f"chmod 700 {data_dir}")
    else:
        yield ok("data folder", f"{data_dir} is this user's alone.")


def _room(settings: Settings) -> Iterator[Finding]:
    existing = next(folder for folder in (settings.data_dir, *settings.data_dir.parents) if folder.exists())
    free = shutil.disk_usage(existing).free
    text = f"{free / 2**30:.1f} GiB are free in {existing}"
    if free < settings.max_upload_bytes:
        yield error(
            "disk",
            f"{text}: less than one mesh may have.",
            "Make room, set CLEAVE_RETENTION_S, or lower CLEAVE_MAX_UPLOAD_BYTES.",
        )
    elif free < _UPLOADS_LEFT * settings.max_upload_bytes:
        yield warning("disk", f"{text}: a few of the largest meshes fill it.", "Make room, or set CLEAVE_RETENTION_S.")
    else:
        yield ok("disk", f"{text}.")
