"""The outbox: pending deliveries of webhooks, one for each job that has a webhook, from its acceptance on."""

import time
from collections.abc import Iterable
from dataclasses import dataclass

from pydantic import TypeAdapter

from worker.jobs.job import is_job_id
from worker.jobs.objects.interface import ObjectStorage, name_of

_FOLDER = "outbox"


@dataclass(frozen=True, slots=True)
class Delivery:
    """The state of the delivery of a job's webhook."""

    failures: int = 0
    due_at: float = 0.0  # of the next attempt, in seconds since 1970


_DELIVERY = TypeAdapter(Delivery)


class Outbox:
    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects

    def put(self, job_id: str, delivery: Delivery) -> None:
        self._objects.put(_key(job_id), _DELIVERY.dump_json(delivery))

    def job_ids(self) -> set[str]:
        """Return the jobs whose webhooks are not delivered yet."""
        return {name for name in map(name_of, self._objects.keys_below(_FOLDER)) if is_job_id(name)}

    def deliveries(self, job_ids: Iterable[str]) -> dict[str, Delivery]:
        """Return the pending deliveries of some jobs."""
        names = list(job_ids)
        found = dict(zip(names, self._objects.each(self.delivery, names), strict=True))
        return {name: delivery for name, delivery in found.items() if delivery is not None}

    def delivery(self, job_id: str) -> Delivery | None:
        text = self._objects.get(_key(job_id))
        return None if text is None else _DELIVERY.validate_json(text)

    def remove(self, job_id: str) -> None:
        self._objects.delete(_key(job_id))

    def remove_old(self, job_id: str, older_than_s: float) -> None:
        """Remove a delivery that was last written longer ago than this."""
        oldest = time.time() - older_than_s
        if any(one.name == job_id and one.modified_at < oldest for one in self._objects.list_below(_FOLDER)):
            self.remove(job_id)


def _key(job_id: str) -> str:
    return f"{_FOLDER}/{job_id}"
