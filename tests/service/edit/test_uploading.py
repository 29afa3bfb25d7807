"""Labels that were made elsewhere: every format in which the service sends labels is taken back."""

import io
from typing import Any

import httpx
import numpy as np
import pytest

from helpers.api import FACES, problem
from helpers.edits.requests import edit, labels

MADE = (np.arange(FACES) * 4 // FACES).tolist()  # four parts of consecutive faces


def npy(values: Any) -> bytes:
    file = io.BytesIO()
    np.save(file, values)
    return file.getvalue()


def put(api: httpx.Client, job: str, body: bytes, media_type: str, **query: object) -> httpx.Response:
    return api.put(f"{job}/labels", content=body, headers={"Content-Type": media_type}, params=query)  # type: ignore[arg-type]


@pytest.mark.parametrize("format_name", ["json", "runs", "seg", "npy", "raw"])
def test_what_the_service_sends_it_takes_back(api: httpx.Client, job: str, format_name: str) -> None:
    edit(api, job, 0, {"op": "name", "part": 1, "name": "arm"}, {"op": "class", "part": 1, "class": "limb"})
    edit(api, job, 1, {"op": "merge", "parts": [1, 2]})
    sent = api.get(f"{job}/labels", params={"revision": 1, "format": format_name})
    answer = put(api, job, sent.content, sent.headers["Content-Type"], base=2)
    assert answer.status_code == 201, answer.text
    assert labels(api, job, revision=3) == labels(api, job, revision=1)
    has_names = format_name in ("json", "runs")
    assert answer.json()["parts"][1]["name"] == ("arm" if has_names else "")
    assert answer.json()["parts"][1]["class"] == ("limb" if has_names else "")
    assert answer.json()["revision"]["parent"] == 2


@pytest.mark.parametrize("values", [np.array(MADE, ">u2"), np.array(MADE, "<i8"), np.array(MADE, "u1")])
def test_an_array_may_have_any_integers(api: httpx.Client, job: str, values: Any) -> None:
    assert put(api, job, npy(values), "application/x-npy").status_code == 201
    assert labels(api, job, revision="latest") == MADE


def test_labels_with_gaps_and_class_names_become_parts_with_classes(api: httpx.Client, job: str) -> None:
    body = {"labels": [2 * label for label in MADE], "classes": ["", "", "arm", "", "leg"]}
    answer = api.put(f"{job}/labels", json=body)
    assert answer.status_code == 201, answer.text
    assert [part["class"] for part in answer.json()["parts"]] == ["", "arm", "leg", ""]
    assert labels(api, job, revision=1) == MADE


def test_a_list_is_enough(api: httpx.Client, job: str) -> None:
    assert api.put(f"{job}/labels", json=MADE).status_code == 201
    assert labels(api, job, revision=1) == MADE


@pytest.mark.parametrize(
    ("body", "media_type", "sentence"),
    [
        (b"0\n1\n", "text/plain", f"a label for each of the {FACES} faces of the file, not 2."),
        (b"", "text/plain", "not 0."),
        (b"0\n1.5\n", "text/plain", "Label 2 of the file is '1.5'"),
        (b"0 1 " + b"9" * 40, "text/plain", "Label 3 of the file is '999"),
        (b"-1\n" * FACES, "text/plain", "face 0 has -1"),
        (npy(np.zeros(FACES)), "application/x-npy", "not float64"),
        (npy(np.zeros((FACES, 1), int)), "application/x-npy", "of shape"),
        (npy(np.array([{}] * FACES)), "application/x-npy", "not object"),
        (npy(np.zeros(FACES, int))[:-1], "application/x-npy", "cut short"),
        (b"\x93NUMPY\x01\x00", "application/x-npy", "not a .npy file"),
        (b"abc", "application/octet-stream", "not 3 bytes"),
        (b'{"labels": [0, "1"]}', "application/json", "labels.1 is not valid"),
        (b'{"labels": [%d]}' % 10**30, "application/json", "larger than 64 bits"),
        (b"[", "application/json", "not valid"),
        (b'{"values": [0], "lengths": [3]}', "application/vnd.cleave.runs+json", f"add up to the {FACES} faces"),
        (b'{"values": [0], "lengths": [-3]}', "application/vnd.cleave.runs+json", "at least 1"),
        (b'{"values": [0], "lengths": []}', "application/vnd.cleave.runs+json", "for each value"),
    ],
)
def test_what_is_no_label_of_every_face_is_refused(
    api: httpx.Client, job: str, body: bytes, media_type: str, sentence: str
) -> None:
    detail = problem(put(api, job, body, media_type), 422, "invalid_parameters")["detail"]
    assert sentence in str(detail)
    assert api.get(f"{job}/revisions").json()["newest"] == 0


def test_another_media_type_is_refused(api: httpx.Client, job: str) -> None:
    problem(put(api, job, b"0", "image/png"), 415, "unsupported_media_type")


def test_labels_replace_the_newest_revision_only(api: httpx.Client, job: str) -> None:
    assert api.put(f"{job}/labels", json=MADE).status_code == 201
    problem(api.put(f"{job}/labels", json=MADE), 409, "revision_conflict")
    problem(api.put(f"{job}/labels", json=MADE, params={"base": 5}), 404, "revision_not_found")
    tag = api.get(f"{job}/labels", params={"revision": "latest", "format": "seg"}).headers["ETag"]
    assert api.put(f"{job}/labels", json=MADE[::-1], headers={"If-Match": tag}).status_code == 201
    refused = api.put(f"{job}/labels", json=MADE, headers={"If-Match": tag})
    assert problem(refused, 412, "precondition_failed")["revision"]["number"] == 2  # type: ignore[index]
    assert api.put(f"{job}/labels", json=MADE, headers={"If-Match": "*"}).status_code == 201
    assert labels(api, job, revision=3) == MADE


def test_labels_that_are_sent_again_make_one_revision(api: httpx.Client, job: str) -> None:
    headers = {"Idempotency-Key": "labels"}
    first = api.put(f"{job}/labels", json=MADE, headers=headers)
    assert api.put(f"{job}/labels", json=MADE, headers=headers).json() == first.json()
    assert api.get(f"{job}/revisions").json()["newest"] == 1
