"""Labels in every form say the same, and the client chooses the form."""

import io
from collections.abc import Callable

import httpx
import numpy as np
import pytest

from helpers.api import problem
from service.answer.label_formats import LABELS, LabelsFormat, negotiate
from service.problems import Problem


def test_every_form_says_the_same(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    url = f"{finished_job()}/labels?segments=5"
    labels = np.array(client.get(url).json()["labels"])
    runs = client.get(f"{url}&format=runs").json()
    assert np.repeat(runs["values"], runs["lengths"]).tolist() == labels.tolist()
    assert client.get(f"{url}&format=seg").text.split() == [str(label) for label in labels]
    assert np.load(io.BytesIO(client.get(f"{url}&format=npy").content)).tolist() == labels.tolist()
    assert np.frombuffer(client.get(f"{url}&format=raw").content, "<i4").tolist() == labels.tolist()


@pytest.mark.parametrize("name", LABELS)
def test_a_form_is_chosen_by_query_or_by_accept(
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
def test_the_best_liked_form_is_sent(accept: str, expected: str) -> None:
    assert negotiate(accept) == expected


@pytest.mark.parametrize("accept", ["image/png", "*/*;q=0", "application/json;q=x", ",", ";", "q=1"])
def test_who_likes_no_form_is_told_which_there_are(accept: str) -> None:
    with pytest.raises(Problem, match="application/x-npy"):
        negotiate(accept)


def test_a_form_that_is_none_is_refused(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    path = finished_job()
    problem(client.get(f"{path}/labels", headers={"Accept": "image/png"}), 406, "not_acceptable")
    problem(client.get(f"{path}/labels?format=xml"), 422, "invalid_request")
