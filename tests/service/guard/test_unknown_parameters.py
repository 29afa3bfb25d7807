"""What the API does not know in a query is refused with the nearest known name, never ignored."""

from collections.abc import Callable

import httpx
import pytest

from helpers.api import problem, submit
from helpers.jobs import sphere


@pytest.mark.parametrize(
    ("path", "meant"),
    [
        ("labels?segment=4", "'segments'"),
        ("labels?Segments=4", "'segments'"),
        ("model.glb?level=all", "'levels'"),
        ("model.obj?names=3:arm", "'name'"),
        ("events?segments=3", "no other"),
        ("hierarchy?segments=3", "the only one is 'revision'"),
        ("?waits=3", "'wait'"),
    ],
)
def test_a_misspelt_parameter_is_refused_with_the_nearest_one(
    client: httpx.Client, finished_job: Callable[..., str], path: str, meant: str
) -> None:
    job = finished_job()
    answer = client.get(job + (path if path.startswith("?") else f"/{path}"))
    detail = str(problem(answer, 422, "invalid_request")["detail"])
    assert meant in detail


@pytest.mark.parametrize(
    ("query", "sentence"),
    [
        ({"segment": "4"}, "nearest one is 'segments'"),
        ({"wait": "30"}, "Prefer: wait=SECONDS"),
        ({"max_segments": "30"}, "parameters="),
        ({"api_key": "secret"}, "Authorization: Bearer KEY"),
        ({"colour": "red"}, "there are file_name, format"),
    ],
)
def test_a_submission_with_an_unknown_parameter_creates_no_job(
    client: httpx.Client, query: dict[str, str], sentence: str
) -> None:
    answer = client.post("/v1/jobs", files={"mesh": ("mesh.off", sphere(12))}, params=query)
    assert sentence in str(problem(answer, 422, "invalid_request")["detail"])
    assert client.get("/v1/jobs").json()["jobs"] == []


@pytest.mark.parametrize("method", ["POST", "DELETE"])
def test_changes_refuse_unknown_parameters_too(client: httpx.Client, method: str) -> None:
    path = submit(client)
    problem(
        client.request(method, f"{path}/cancel?force=1" if method == "POST" else f"{path}?force=1"),
        422,
        "invalid_request",
    )
    assert client.get(path).json()["status"] == "queued"


def test_pages_and_their_files_take_any_query(client: httpx.Client) -> None:
    for path in ("/?utm_source=mail", "/docs?theme=dark", "/healthz?probe=1"):
        assert client.get(path).status_code == 200


def test_an_unknown_parameter_of_the_method_is_refused_with_the_nearest_one(client: httpx.Client) -> None:
    answer = client.post(
        "/v1/jobs", files={"mesh": ("mesh.off", sphere(12))}, data={"parameters": '{"max_segment": 9}'}
    )
    assert "nearest one is 'max_segments'" in str(problem(answer, 422, "invalid_parameters")["detail"])
