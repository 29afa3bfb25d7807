"""Fills a data folder with very many jobs by the layout of the store, far faster than by submitting them.

The files of a job are as the service leaves them. Equal files are names of one file, which saves space; only the record
differs from job to job.
"""

from __future__ import annotations

import os
import random
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from datetime import datetime, timedelta
from hashlib import sha256
from pathlib import Path

from bench.load.meshes import wavy_torus
from cleave.version import installed_version
from segcore.parameters import SegmentationParameters
from worker.jobs.attempts import Attempt
from worker.jobs.job import Canceled, Failed, Job, Outcome, Succeeded, now
from worker.jobs.objects.local import LocalObjects
from worker.jobs.store.batches import Batch, BatchStore
from worker.jobs.store.computed import computed_key
from worker.jobs.store.deletion import memory_key
from worker.jobs.store.ended import ended_key
from worker.jobs.store.index import timeline_key
from worker.jobs.store.layout import MANIFEST, RECORD, RESULT, LayoutVersion, entry_name, job_key, mesh_name
from worker.jobs.store.pending import marker_key
from worker.jobs.store.records import ATTEMPT, JOB, OUTCOME

OWNERS = ("anna", "ben", "chen", "dana", None)
_TOGETHER = 20  # jobs that an owner submits within a minute
_PERIOD = timedelta(days=365)
_STATUSES = ("succeeded",) * 17 + ("failed",) * 2 + ("canceled",)  # of the jobs that are submitted together
_RESULT = bytes(50_000)
_MOST_NAMES = 60_000  # of a file; ext4 allows 65,000
_SAMPLES = 100
_REMEMBERED = 20  # contents; those of the present jobs and the frequent ones are used last


@dataclass(frozen=True, slots=True)
class Filled:
    """Some jobs of a filled folder."""

    samples: list[Job]  # ended ones of the first owner, over the whole year, newest first


def fill(data_dir: Path, jobs: int, expired: int = 0) -> Filled:
    """Fill a folder with ended jobs of several owners over a year, batches, and memories of deleted jobs.

    Parameters
    ----------
    expired : this many of the jobs, a multiple of 20, are a year older than the others.
    """
    filler, owned = _Filler(data_dir), []
    year_began = now() - _PERIOD
    for first in range(0, jobs, _TOGETHER):
        owner = OWNERS[first // _TOGETHER % len(OWNERS)]
        at = year_began + _PERIOD * (first / jobs) - (_PERIOD if first < expired else timedelta(0))
        ended = filler.add_ended(owner, at, min(_TOGETHER, jobs - first))
        if first // _TOGETHER % 10 == 0:
            filler.add_batch(owner, at, ended)
        if owner == OWNERS[0] and first >= expired:
            owned.append(ended[0])
    LayoutVersion(LocalObjects(data_dir)).make_current()
    return Filled(owned[:: -max(1, len(owned) // _SAMPLES)])


def fill_waiting(data_dir: Path, jobs: int) -> None:
    """Fill a folder with jobs that wait."""
    filler = _Filler(data_dir)
    began_at = now() - timedelta(seconds=jobs)
    for number in range(jobs):
        filler.add_waiting(OWNERS[0], began_at + timedelta(seconds=number))
    LayoutVersion(LocalObjects(data_dir)).make_current()


class _Filler:
    """Writes jobs with one mesh and random seeds."""

    def __init__(self, data_dir: Path) -> None:
        self._random = random.Random(0)
        self._links = _Links(data_dir)
        self._batches = BatchStore(LocalObjects(data_dir))
        self._mesh = wavy_torus(500)
        self._parameters = asdict(SegmentationParameters())
        self._template = Job(
            id="",
            sha256=sha256(self._mesh).hexdigest(),
            size_bytes=len(self._mesh),
            mesh_format="ply",
            parameters={},
            created_at=now(),
            file_name="torus.ply",
            version=installed_version(),
        )

    def add_ended(self, owner: str | None, at: datetime, count: int) -> list[Job]:
        """Add jobs that end together, half a minute after the first was submitted."""
        attempt = ATTEMPT.dump_json(Attempt(number=1, worker="host.1", started_at=at))
        outcomes = _outcomes(at + timedelta(seconds=30))
        manifests = {status: OUTCOME.dump_json(outcome) for status, outcome in outcomes.items()}
        jobs = []
        for number in range(count):
            job = self._add_job(owner, at + timedelta(seconds=number))
            status = _STATUSES[number % len(_STATUSES)]
            result = _RESULT if status == "succeeded" else b""
            self._links.add(job_key(job.id, "attempt-1.json"), attempt)
            self._links.add(job_key(job.id, MANIFEST), manifests[status])
            self._links.add(ended_key(job.id, outcomes[status], len(self._mesh) + len(result)), b"")
            if result:
                self._links.add(job_key(job.id, RESULT), result)
                self._links.add(computed_key(job), b"")
            jobs.append(job)
        return jobs

    def add_waiting(self, owner: str | None, at: datetime) -> None:
        self._links.add(marker_key(self._add_job(owner, at)), b"")

    def add_batch(self, owner: str | None, at: datetime, jobs: list[Job]) -> None:
        """Add a batch of some jobs, and the memory of one that was deleted."""
        self._batches.add(Batch(id=self._id(), owner=owner, created_at=at, job_ids=[job.id for job in jobs]))
        self._links.add(memory_key(self._id()), (owner or "").encode())

    def _add_job(self, owner: str | None, at: datetime) -> Job:
        parameters = {**self._parameters, "seed": self._random.randrange(10**6)}
        job = replace(self._template, id=self._id(), owner=owner, created_at=at, parameters=parameters)
        self._links.add(job_key(job.id, mesh_name(job)), self._mesh)
        self._links.write(job_key(job.id, RECORD), JOB.dump_json(job))
        self._links.add(timeline_key(owner, entry_name(job)), b"")
        return job

    def _id(self) -> str:
        return f"{self._random.getrandbits(128):032x}"


def _outcomes(at: datetime) -> dict[str, Outcome]:
    return {
        "succeeded": Succeeded(finished_at=at, faces=500, vertices=250, max_segments=20, automatic_segments=5),
        "failed": Failed(finished_at=at, code="invalid_mesh", message="The file has no faces."),
        "canceled": Canceled(finished_at=at),
    }


class _Links:
    """Writes files; equal contents become names of one file, as far as a few contents are remembered."""

    def __init__(self, folder: Path) -> None:
        self._folder = str(folder)
        self._sources: dict[bytes, tuple[str, int]] = {}  # path and number of names by content

    def add(self, key: str, data: bytes) -> None:
        source, names = self._sources.pop(data, ("", _MOST_NAMES))
        if names == _MOST_NAMES:
            while len(self._sources) > _REMEMBERED:
                del self._sources[next(iter(self._sources))]
            self._sources[data] = (self.write(key, data), 1)
            return
        self._in_folder(key, lambda path: os.link(source, path))
        self._sources[data] = (source, names + 1)

    def write(self, key: str, data: bytes) -> str:
        def write(path: str) -> None:
            with open(path, "xb", buffering=0) as file:
                file.write(data)

        return self._in_folder(key, write)

    def _in_folder(self, key: str, write: Callable[[str], None]) -> str:
        path = f"{self._folder}/{key}"
        try:
            write(path)
        except FileNotFoundError:
            os.makedirs(os.path.dirname(path), exist_ok=True)
            write(path)
        return path
