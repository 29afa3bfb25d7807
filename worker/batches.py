"""Batches: jobs that somebody wants to ask about together.

<data>/batches/<id>.json
"""

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from pydantic import TypeAdapter

from worker.durable import create_file
from worker.jobs import is_job_id


@dataclass(frozen=True, slots=True, kw_only=True)
class Batch:
    id: str  # of the form of a job's
    owner: str | None
    created_at: datetime  # UTC
    job_ids: list[str]  # in the order in which they were sent


_BATCH = TypeAdapter(Batch)


class BatchStore:
    def __init__(self, data_dir: Path) -> None:
        self._folder = data_dir / "batches"
        self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)

    def add(self, batch: Batch) -> None:
        create_file(self._path(batch.id), _BATCH.dump_json(batch))

    def find(self, batch_id: str) -> Batch | None:
        if not is_job_id(batch_id):
            return None
        try:
            return _BATCH.validate_json(self._path(batch_id).read_bytes())
        except FileNotFoundError:
            return None

    def delete(self, batch_id: str) -> None:
        self._path(batch_id).unlink(missing_ok=True)

    def _path(self, batch_id: str) -> Path:
        return self._folder / f"{batch_id}.json"
