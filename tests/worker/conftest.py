"""The store in every place where it can be."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from buckets import below
from worker.jobs import new_job_id
from worker.opening import open_folder, open_url
from worker.store import JobStore

PLACES = ("local", "memory", "s3")


@pytest.fixture(params=PLACES)
def placed(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[JobStore]:
    """An empty store: in a folder, in the memory of the process, and in a bucket."""
    match request.param:
        case "local":
            yield open_folder(tmp_path / "data")
        case "memory":
            yield open_url("memory://", tmp_path / "data", 2**20)
        case _:
            yield open_url(below(request.getfixturevalue("s3_url"), new_job_id()), tmp_path / "data", 2**20)
