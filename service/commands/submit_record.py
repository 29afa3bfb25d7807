"""What the results in a folder were made from, so that a second run makes again exactly what has changed."""

import json
import threading
from pathlib import Path

from worker.jobs.objects.durable import replace_file

RECORD = ".cleave-submit.json"


class SubmitRecord:
    """The digests of what results were made from, by the names of their files, in a file of the same folder.

    Threads may share it. A file that is missing or damaged counts as empty: its results are made again.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / RECORD
        self._lock = threading.Lock()
        self._made_from, self._failures = _read(self._path)

    def is_current(self, result: Path, made_from: str) -> bool:
        """Whether a result exists and was made from this."""
        return self._made_from.get(result.name) == made_from and result.exists()

    def add(self, result: Path, made_from: str) -> None:
        """Note what a result was made from, after it was saved."""
        with self._lock:
            self._made_from[result.name] = made_from
            self._write()

    def failures(self, input_digest: str) -> int:
        """Return how many jobs with an input have failed."""
        return self._failures.get(input_digest, 0)

    def add_failure(self, input_digest: str) -> None:
        with self._lock:
            self._failures[input_digest] = self.failures(input_digest) + 1
            self._write()

    def _write(self) -> None:
        document = {"made_from": self._made_from, "failures": self._failures}
        text = json.dumps(document, indent=1, sort_keys=True).encode()
        replace_file(self._path, lambda target: target.write(text), durable=False)


def _read(path: Path) -> tuple[dict[str, str], dict[str, int]]:
    try:
        found = json.loads(path.read_bytes())
        made_from = {str(name): str(digest) for name, digest in found["made_from"].items()}
        return made_from, {str(digest): int(count) for digest, count in found["failures"].items()}
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return {}, {}
