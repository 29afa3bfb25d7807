"""Batches: jobs that were submitted together and are reported together."""

from dataclasses import dataclass, field
from datetime import datetime

from pydantic import TypeAdapter

from worker.jobs.job import is_job_id
from worker.jobs.objects.interface import ObjectStorage


@dataclass(frozen=True, slots=True, kw_only=True)
class Batch:
    id: str  # like that of a job
    owner: str | None
    created_at: datetime  # UTC
    job_ids: list[str]  # in the order of submission
    left_out: list[str] = field(default_factory=list)  # the names of files to which no mesh of the request refers


_BATCH = TypeAdapter(Batch)


class BatchStore:
    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects

    def add(self, batch: Batch) -> None:
        self._objects.create(_key(batch.id), _BATCH.dump_json(batch))

    def find(self, batch_id: str) -> Batch | None:
        text = self._objects.get(_key(batch_id)) if is_job_id(batch_id) else None
        return None if text is None else _BATCH.validate_json(text)

    def delete(self, batch_id: str) -> None:
        self._objects.delete(_key(batch_id))


def _key(batch_id: str) -> str:
    return f"batches/{batch_id}.json"
