"""The stored result file."""

import io
from collections.abc import Callable

import httpx

from helpers.api import problem, submit
from segcore.io.result import read_result
from worker.jobs.store.store import JobStore


def test_the_stored_file_is_sent_unchanged(
    client: httpx.Client, finished_job: Callable[..., str], store: JobStore
) -> None:
    path = finished_job()
    answer = client.get(f"{path}/result.cleave", params={"redirect": "true"})
    with store.results.open(path.rpartition("/")[2]) as file:
        assert answer.content == file.read()
    assert read_result(io.BytesIO(answer.content)).hierarchy.max_segments > 1
    again = client.get(f"{path}/result.cleave", headers={"If-None-Match": answer.headers["ETag"]})
    assert (again.status_code, again.content) == (304, b"")
    problem(client.get(f"{submit(client)}/result.cleave"), 409, "not_finished")
