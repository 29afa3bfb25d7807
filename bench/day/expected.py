"""The labels that a job must have: those that segcore gives directly, in the version that ran the job."""

import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from bench.day.orders import Order
from bench.errors import BenchmarkError
from bench.guarded import Guarded

_DIRECT = Path(__file__).with_name("direct.py")


@dataclass(frozen=True, slots=True)
class Upgrade:
    """The change of the version."""

    at: datetime  # when the previous version was stopped
    waiting: int  # jobs at that time
    running: int


@dataclass(frozen=True, slots=True)
class Versions:
    """segcore before and after the upgrade, each in a process of its own."""

    previous: Guarded
    present: Guarded
    upgraded_at: datetime
    folder: Path  # for mesh files

    @classmethod
    @contextmanager
    def opened(cls, previous: Path, present: Path, upgraded_at: datetime, folder: Path) -> Iterator["Versions"]:
        """Start both; the versions are the roots of their checkouts."""
        with _direct(previous) as before, _direct(present) as after:
            yield cls(before, after, upgraded_at, folder)

    def labels(self, order: Order, finished_at: datetime) -> str:
        """Return the SHA-256 of the labels of a mesh, as the version gives them that finished the job.

        Raises
        ------
        BenchmarkError
            If it gives none.
        """
        path = self.folder / "mesh.ply"
        path.write_bytes(order.mesh)
        version = self.previous if finished_at < self.upgraded_at else self.present
        answer = version.ask(json.dumps({"mesh": str(path), "parameters": dict(order.parameters)}))
        if "sha256" not in answer:
            raise BenchmarkError(f"segcore gives no labels: {answer['error']}.")
        return str(answer["sha256"])


def _direct(root: Path) -> Guarded:
    environment = os.environ | {"PYTHONPATH": str(root), "OPENBLAS_NUM_THREADS": "1"}  # as in a worker
    return Guarded([sys.executable, str(_DIRECT)], environment)
