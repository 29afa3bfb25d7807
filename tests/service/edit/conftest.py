"""A service for all tests of a module, in which every test gets a finished job of its own."""

import sys
from collections.abc import Callable, Iterator

import httpx
import pytest
from redis import Redis

from cleave.settings import Settings
from helpers.edits.requests import KEY, OTHER_KEY
from helpers.jobs import sphere
from helpers.servers import serving
from service.edit import editors
from service.keys import key_digest
from worker.jobs.store.opening import open_store
from worker.jobs.store.store import JobStore
from worker.process.perform import perform


@pytest.fixture(scope="module")
def edit_settings(tmp_path_factory: pytest.TempPathFactory, queue_url: str) -> Settings:
    with Redis.from_url(queue_url) as connection:
        connection.flushall()
    return Settings(
        data_dir=tmp_path_factory.mktemp("edits"),
        redis_url=queue_url,
        api_keys=f"anna:{key_digest(KEY)},ben:{key_digest(OTHER_KEY)}",
        edit_timeout_s=3.0,
    )


@pytest.fixture(scope="module")
def edit_store(edit_settings: Settings) -> JobStore:
    return open_store(edit_settings)


@pytest.fixture(scope="module")
def api(edit_settings: Settings) -> Iterator[httpx.Client]:
    """A client of a service whose processes of edits use a stand-in for a Guide."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(editors, "PROGRAM", ("-m", "helpers.edits.program"))
        patch.setenv("PYTHONPATH", ":".join(path for path in sys.path if path))
        with serving(edit_settings) as client:
            client.headers["Authorization"] = f"Bearer {KEY}"
            yield client


@pytest.fixture(scope="module")
def new_job(api: httpx.Client, edit_settings: Settings, edit_store: JobStore) -> Callable[[], str]:
    """Return a function that returns the path of a new finished job; all of them share one result."""

    def submit() -> str:
        answer = api.post("/v1/jobs", files={"mesh": ("mesh.off", sphere(12))})
        if answer.status_code == 202:
            perform(edit_store, edit_settings, answer.json()["id"], lambda *_: None)
        return str(answer.headers["Location"])

    return submit


@pytest.fixture
def job(new_job: Callable[[], str]) -> str:
    """The path of a finished job without revisions."""
    return new_job()
