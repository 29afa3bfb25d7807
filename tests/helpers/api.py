"""Requests and checks that the tests of the API share."""

from pathlib import Path

import httpx

from helpers.jobs import sphere

FACES = 4 * 12 * 11  # of sphere(12)
UNKNOWN = "/v1/jobs/" + "0" * 32


AGAIN = {"Cache-Control": "no-cache"}  # compute again


def submit(client: httpx.Client, mesh: bytes | None = None, **fields: str) -> str:
    """Submit a mesh and return the path of its job."""
    answer = client.post("/v1/jobs", files={"mesh": ("mesh.off", mesh or sphere(12))}, data=fields, headers=AGAIN)
    assert answer.status_code == 202, answer.text
    return str(answer.headers["Location"])


def problem(answer: httpx.Response, status: int, code: str) -> dict[str, object]:
    """Check that a response is a problem with a status and a code; return its body."""
    assert answer.status_code == status, answer.text
    assert answer.headers["Content-Type"] == "application/problem+json"
    body: dict[str, object] = answer.json()
    assert (body["status"], body["code"]) == (status, code)
    assert str(body["detail"]).endswith(".")
    return body


def traces(data_dir: Path) -> list[Path]:
    """Return all files of jobs and uploads in a data folder."""
    folders = ("jobs", "pending", "incoming", "timeline", "ended", "computed")
    return [file for folder in folders for file in (data_dir / folder).rglob("*") if file.is_file()]


def samples(client: httpx.Client) -> dict[str, float]:
    """Return the values of the metrics by name and labels."""
    answer = client.get("/metrics")
    assert answer.headers["Content-Type"].startswith("text/plain")
    lines = [line for line in answer.text.splitlines() if not line.startswith("#")]
    return {name: float(value) for name, _, value in (line.rpartition(" ") for line in lines)}
