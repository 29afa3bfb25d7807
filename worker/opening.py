"""How the store of an installation is opened."""

from pathlib import Path

from worker.settings import Settings
from worker.store import JobStore


def open_store(settings: Settings) -> JobStore:
    """The store that the settings name."""
    return open_folder(settings.data_dir)


def open_folder(data_dir: Path) -> JobStore:
    """The store in a folder of this machine."""
    return JobStore(data_dir)
