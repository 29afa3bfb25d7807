"""Migration of data folders of earlier versions: objects are renamed when a store is opened."""

import json
import os
from contextlib import suppress
from datetime import datetime
from pathlib import Path

from worker.jobs.job import is_job_id
from worker.jobs.store.index import complemented, is_entry_name
from worker.jobs.store.layout import TIME_FORMAT

_ID_LENGTH = 32
_THIS_MILLENNIUM = "2"  # the first digit of a time that is not complemented, until the year 3000


def migrate(data_dir: Path) -> None:
    """Rename the objects that have old names, if any; several processes may do so at once."""
    for folder in _scan(data_dir / "index"):
        for entry in _scan(Path(folder)):
            if entry.name.startswith(_THIS_MILLENNIUM) and is_entry_name(entry.name):
                _rename(Path(entry), complemented(entry.name))
    for folder in _scan(data_dir / "computed"):
        for entry in _scan(Path(folder)):
            if entry.is_file():  # of a version in which one job stood for all with the same input
                Path(entry).unlink(missing_ok=True)
    for marker in _scan(data_dir / "pending"):
        job_id, owner = marker.name[:_ID_LENGTH], marker.name[_ID_LENGTH:]
        if is_job_id(job_id) and owner[:1] in ("", "."):
            with suppress(FileNotFoundError):
                record = json.loads((data_dir / "jobs" / job_id / "job.json").read_bytes())
                accepted_at = datetime.fromisoformat(record["created_at"])
                _rename(Path(marker), f"{accepted_at:{TIME_FORMAT}}-{job_id}{owner}")


def _scan(folder: Path) -> list[os.DirEntry[str]]:
    try:
        return list(os.scandir(folder))
    except FileNotFoundError:
        return []


def _rename(path: Path, name: str) -> None:
    with suppress(FileNotFoundError):
        path.rename(path.with_name(name))
