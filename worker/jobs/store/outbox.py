"""Messages that are still to be sent: one for each job that has a webhook, from its acceptance to its delivery."""

import time
from dataclasses import dataclass

from pydantic import TypeAdapter

from worker.jobs.job import is_job_id
from worker.jobs.objects.seam import ObjectStorage, name_of

_FOLDER = "outbox"


@dataclass(frozen=True, slots=True)
class Letter:
    """How far the delivery is."""

    failures: int = 0
    due_at: float = 0.0  # seconds since 1970


_LETTER = TypeAdapter(Letter)


class Outbox:
    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects

    def put(self, job_id: str, letter: Letter) -> None:
        self._objects.put(_key(job_id), _LETTER.dump_json(letter))

    def job_ids(self) -> set[str]:
        """The jobs about which somebody is still to be told."""
        return set(self._names())

    def letters(self, but_of: frozenset[str] | set[str] = frozenset()) -> dict[str, Letter]:
        """What is still to be sent, by job, without that of some jobs."""
        names = [name for name in self._names() if name not in but_of]
        found = dict(zip(names, self._objects.each(self.letter, names), strict=True))
        return {name: letter for name, letter in found.items() if letter is not None}

    def letter(self, job_id: str) -> Letter | None:
        text = self._objects.get(_key(job_id))
        return None if text is None else _LETTER.validate_json(text)

    def remove(self, job_id: str) -> None:
        self._objects.delete(_key(job_id))

    def remove_old(self, job_id: str, older_than_s: float) -> None:
        oldest = time.time() - older_than_s
        if any(one.name == job_id and one.modified_at < oldest for one in self._objects.list_below(_FOLDER)):
            self.remove(job_id)

    def _names(self) -> list[str]:
        return [name for name in map(name_of, self._objects.keys_below(_FOLDER)) if is_job_id(name)]


def _key(job_id: str) -> str:
    return f"{_FOLDER}/{job_id}"
