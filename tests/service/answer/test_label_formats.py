"""Labels are the same in all formats, and the client selects the format."""

import io
from collections.abc import Callable

import httpx
import numpy as np
import pytest

from helpers.api import problem
from service.answer.label_formats import LABELS, LabelsFormat, negotiate
from service.problems import Problem


def test_all_formats_contain_the_same_labels(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    url = f"{finished_job()}/labels?segments=5"
    labels = np.array(client.get(url).json()["labels"])
    runs = client.get(f"{url}&format=runs").json()
    assert np.repeat(runs["values"], runs["lengths"]).tolist() == labels.tolist()
    assert client.get(f"{url}&format=seg").text.split() == [str(label) for label in labels]
    assert np.load(io.BytesIO(client.get(f"{url}&format=npy").content)).tolist() == labels.tolist()
    assert np.frombuffer(client.get(f"{url}&format=raw").content, "<i4").tolist() == labels.tolist()


@pytest.mark.parametrize("name", LABELS)
def test_a_format_is_selected_by_query_or_by_accept(
    client: httpx.Client, finished_job: Callable[..., str], name: LabelsFormat
) -> None:
    url, media_type = f"{finished_job()}/labels", LABELS[name].media_type
    asked = client.get(url, params={"format": name})
    accepted = client.get(url, headers={"Accept": media_type})
    assert asked.content == accepted.content
    assert asked.headers["Content-Type"] == accepted.headers["Content-Type"] == media_type
    assert asked.headers["ETag"] == accepted.headers["ETag"]
    assert (asked.headers["Vary"], accepted.headers["Vary"]) == ("Accept-Encoding", "Accept, Accept-Encoding")


@pytest.mark.parametrize(
    ("accept", "expected"),
    [
        ("*/*", "json"),
        ("", "json"),
        ("application/*", "json"),
        ("text/*", "seg"),
        ("text/plain;q=0.5, application/x-npy;q=0.8", "npy"),
        ("application/json;q=0, */*;q=0.1", "runs"),
        ("text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8", "json"),
        ("APPLICATION/OCTET-STREAM", "raw"),
    ],
)
def test_the_preferred_format_is_selected(accept: str, expected: str) -> None:
    assert negotiate(accept) == expected


@pytest.mark.parametrize("accept", ["image/png", "*/*;q=0", "application/json;q=x", ",", ";", "q=1"])
def test_a_refusal_lists_the_available_formats(accept: str) -> None:
    with pytest.raises(Problem, match="application/x-npy"):
        negotiate(accept)


def test_an_unknown_format_is_refused(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    path = finished_job()
    problem(client.get(f"{path}/labels", headers={"Accept": "image/png"}), 406, "not_acceptable")
    problem(client.get(f"{path}/labels?format=xml"), 422, "invalid_request")
