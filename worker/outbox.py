"""Messages that are still to be sent: one for each job that has a webhook, from its acceptance to its delivery.

<data>/outbox/<id>   {"failures": int, "due_at": seconds since 1970}
"""

import os
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from pydantic import TypeAdapter

from worker.durable import replace_file
from worker.jobs import is_job_id


@dataclass(frozen=True, slots=True)
class Letter:
    """How far the delivery is."""

    failures: int = 0
    due_at: float = 0.0  # seconds since 1970


_LETTER = TypeAdapter(Letter)


class Outbox:
    def __init__(self, data_dir: Path) -> None:
        self._folder = data_dir / "outbox"
        self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)

    def put(self, job_id: str, letter: Letter) -> None:
        replace_file(self._folder / job_id, lambda target: target.write(_LETTER.dump_json(letter)))

    def letters(self) -> dict[str, Letter]:
        """What is still to be sent, by job."""
        names = [name for name in os.listdir(self._folder) if is_job_id(name)]
        found = {name: self._read(name) for name in names}
        return {name: letter for name, letter in found.items() if letter is not None}

    def remove(self, job_id: str) -> None:
        (self._folder / job_id).unlink(missing_ok=True)

    def remove_old(self, job_id: str, older_than_s: float) -> None:
        with suppress(FileNotFoundError):
            if (self._folder / job_id).stat().st_mtime < time.time() - older_than_s:
                self.remove(job_id)

    def _read(self, name: str) -> Letter | None:
        try:
            return _LETTER.validate_json((self._folder / name).read_bytes())
        except FileNotFoundError:
            return None
