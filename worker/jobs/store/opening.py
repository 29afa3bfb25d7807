"""Opens the store of an installation: in the data folder, or in a bucket if CLEAVE_STORE_URL names one."""

from pathlib import Path

from cleave.settings import InvalidSettings, Settings
from cleave.version import extra_command
from worker.jobs.objects.file_cache import FileCache
from worker.jobs.objects.local import LocalObjects
from worker.jobs.store.layout import LayoutVersion
from worker.jobs.store.migration import rename_at_once
from worker.jobs.store.spool import Spool
from worker.jobs.store.store import JobStore

_SPOOL, _CACHE = "incoming", "cache"


def open_store(settings: Settings) -> JobStore:
    """Open the store that the settings name.

    Raises
    ------
    InvalidSettings
        If the URL is not that of a store, or the optional dependency for buckets is not installed.
    """
    if settings.store_url is None:
        return open_folder(settings.data_dir)
    return open_url(settings.store_url, settings.data_dir, settings.store_cache_bytes)


def open_folder(data_dir: Path) -> JobStore:
    """Open the store in a folder, which several machines may share."""
    objects = LocalObjects(data_dir)
    if not LayoutVersion(objects).is_current():
        rename_at_once(data_dir)
    return JobStore(objects, Spool(data_dir / _SPOOL))


def open_url(url: str, data_dir: Path, cache_bytes: int) -> JobStore:
    """Open the store in a bucket; ``data_dir`` is for uploads and for a cache of results."""
    try:
        from worker.jobs.objects.buckets import open_bucket
        from worker.jobs.objects.remote import RemoteObjects
    except ModuleNotFoundError as error:
        raise InvalidSettings(f"CLEAVE_STORE_URL needs an optional dependency: {extra_command('cloud')}.") from error
    spool = Spool(data_dir / _SPOOL)
    return JobStore(RemoteObjects(open_bucket(url), spool.folder), spool, FileCache(data_dir / _CACHE, cache_bytes))
