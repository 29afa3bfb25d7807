"""Requests of edits that the tests of the API share."""

from typing import Any

import httpx

from service.keys import new_key

KEY, OTHER_KEY = new_key(), new_key()  # of anna and ben


def edit(api: httpx.Client, job: str, base: int, *operations: dict[str, Any], **said: Any) -> dict[str, Any]:
    """Make the next revision and return the document of the response."""
    body = {"base": base, "operations": list(operations), **said}
    if any(operation["op"] in ("part", "cut", "border", "smooth") for operation in operations):
        wait_for_guide(api, job, body)
    answer = api.post(f"{job}/edits", json=body)
    assert answer.status_code == 201, answer.text
    document: dict[str, Any] = answer.json()
    return document


def labels(api: httpx.Client, job: str, **query: object) -> list[int]:
    """Return the labels of a job."""
    answer = api.get(f"{job}/labels", params={name: str(value) for name, value in query.items()})
    assert answer.status_code == 200, answer.text
    found: list[int] = answer.json()["labels"]
    return found


def wait_for_guide(api: httpx.Client, job: str, body: dict[str, Any]) -> None:
    """Wait until the mesh of a job is prepared for edits, so that one does not go through the queue."""
    while True:
        answer = api.post(f"{job}/edits/preview", json=body)
        if answer.status_code != 503 or answer.json()["code"] != "guide_not_ready":
            return
