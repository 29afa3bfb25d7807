"""A job is run again with other parameters, without its file."""

from collections.abc import Callable

import httpx

from cleave.settings import Settings
from helpers.api import UNKNOWN, problem
from helpers.jobs import sphere
from worker.jobs.store.store import JobStore


def test_a_job_is_run_again_with_other_parameters(
    client: httpx.Client, finished_job: Callable[..., str], store: JobStore
) -> None:
    mesh = sphere(12)
    first = client.get(finished_job(mesh, unit="mm", up="z")).json()
    answer = client.post(f"{first['links']['self']}/rerun", json={"max_segments": 3})
    assert answer.status_code == 202
    again = answer.json()
    assert answer.headers["Location"] == again["links"]["self"] != first["links"]["self"]
    assert again["input"] == first["input"]
    assert again["parameters"] == {**first["parameters"], "max_segments": 3}
    with store.open_mesh(again["id"]) as file:
        assert file.read() == mesh
    record = store.records.job(again["id"])
    assert record is not None
    assert (record.unit, record.up) == ("millimeter", "z")
    client.delete(first["links"]["self"])
    assert client.get(again["links"]["self"]).status_code == 200


def test_a_rerun_shares_results_and_idempotency_keys_as_a_submission_does(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    path = finished_job()
    shared = client.post(f"{path}/rerun", headers={"Prefer": "wait=1"})
    assert shared.status_code == 200
    assert len(shared.json()["labels"]) == shared.json()["mesh"]["faces"]
    assert client.post(f"{path}/rerun", json={}, headers={"Cache-Control": "no-cache"}).status_code == 202
    locations = {
        client.post(f"{path}/rerun", json={"seed": 2}, headers={"Idempotency-Key": "once"}).headers["Location"]
        for _ in range(2)
    }
    assert len(locations) == 1


def test_a_rerun_that_cannot_be_is_a_problem(
    client: httpx.Client, finished_job: Callable[..., str], settings: Settings
) -> None:
    path = finished_job()
    problem(client.post(f"{UNKNOWN}/rerun", json={}), 404, "job_not_found")
    problem(client.post(f"{path}/rerun", json={"seed": -1}), 422, "invalid_parameters")
    problem(client.post(f"{path}/rerun", content=b" " * 20_000), 422, "invalid_parameters")
    mesh = sphere(12)
    for file in settings.data_dir.rglob("*"):
        if file.is_file() and file.read_bytes() == mesh:
            file.unlink()
    problem(client.post(f"{path}/rerun", json={"seed": 1}), 410, "input_lost")
