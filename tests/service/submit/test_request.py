"""Uploads without a form, file names and parameters."""

import io
from pathlib import Path

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import problem, traces
from helpers.uploads import form, part, post_form
from segcore.errors import InvalidParameters
from service.submit.request import file_label, mesh_format, parse_parameters
from worker.jobs.store.store import JobStore


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("hand.off", "off"),
        ("HAND.STL", "stl"),
        ("../../etc/passwd", None),
        ("/etc/shadow.ply", "ply"),
        ("a\0b.off", "off"),
        ("..", None),
        ("", None),
        (None, None),
        ("model.exe", None),
    ],
)
def test_the_extension_of_a_file_name_declares_the_format(name: str | None, expected: str | None) -> None:
    assert mesh_format(name) == expected


def test_a_file_name_never_becomes_a_path(client: httpx.Client, settings: Settings, tmp_path: Path) -> None:
    for name in ("../../../escape.off", str(tmp_path / "escape.off"), "a\x00b.off"):
        assert client.post("/v1/jobs", files={"mesh": (name, io.BytesIO(b"abc"))}).status_code == 202
    outside = {file for file in tmp_path.rglob("*") if file.is_file()} - set(traces(settings.data_dir))
    assert outside == set()
    assert {file.name[:5] for file in (settings.data_dir / "jobs").rglob("*") if file.is_file()} == {"mesh-", "job.j"}


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("hand.off", "hand.off"),
        ("../../etc/passwd", "passwd"),
        ("C:\\meshes\\hand.off", "hand.off"),
        ("a\0b\n\x1b[31m.off", "ab[31m.off"),
        ("\ud800hand", "hand"),
        ("x" * 300, "x" * 255),
        ("..", ".."),
        ("/", None),
        ("", None),
        (None, None),
    ],
)
def test_a_file_name_is_shown_without_what_could_do_harm(name: str | None, label: str | None) -> None:
    assert file_label(name) == label


@pytest.mark.parametrize(
    "text",
    [
        b"NaN",
        b"[]",
        b"1",
        b"null",
        b'"text"',
        b"{",
        b"\xff\xfe",
        b'{"max_segments": NaN}',
        b'{"max_segments": 1e999}',
        b'{"max_segments": Infinity}',
        b'{"max_segments": "\\ud800"}',
        b'{"\\ud800": 1}',
        b'{"max_segments": 0}',
        b'{"max_segments": true}',
        b'{"max_segments": [1]}',
        b'{"max_segments": ' + b"9" * 10_000 + b"}",
        b"[" * 10_000,
        b'{"unknown": 1}',
    ],
)
def test_invalid_parameters_are_refused(client: httpx.Client, text: bytes) -> None:
    with pytest.raises(InvalidParameters):
        parse_parameters(text)
    status, code = post_form(client, form(part("mesh", b"abc"), part("parameters", text)))
    assert (status, code) == (422, "invalid_parameters")


def raw(client: httpx.Client, body: bytes, url: str = "/v1/jobs", **headers: str) -> httpx.Response:
    return client.post(url, content=body, headers={name.replace("_", "-"): value for name, value in headers.items()})


@pytest.mark.parametrize(
    ("query", "headers", "declared"),
    [
        ("", {}, None),
        ("", {"content_type": "application/octet-stream"}, None),
        ("", {"content_type": "model/stl"}, "stl"),
        ("?format=ply", {}, "ply"),
        ("?format=.OBJ", {"content_type": "application/x-www-form-urlencoded"}, "obj"),
        ("?format=stl", {"content_type": "model/off"}, "stl"),
        ("?file_name=hand.off", {}, "off"),
    ],
)
def test_the_body_can_be_the_mesh_itself(
    client: httpx.Client, store: JobStore, query: str, headers: dict[str, str], declared: str | None
) -> None:
    answer = raw(client, b"abc", f"/v1/jobs{query}", **headers)
    assert answer.status_code == 202, answer.text
    assert answer.json()["input"]["format"] == declared
    with store.open_mesh(answer.json()["id"]) as mesh:
        assert mesh.read() == b"abc"


def test_parameters_can_be_given_in_the_query(client: httpx.Client) -> None:
    answer = client.post("/v1/jobs", content=b"abc", params={"parameters": '{"seed": 9}'})
    assert answer.json()["parameters"]["seed"] == 9
    refused = client.post("/v1/jobs", content=b"abc", params={"parameters": '{"seed": -9}'})
    problem(refused, 422, "invalid_parameters")


def test_parameters_in_form_and_query_are_refused(client: httpx.Client) -> None:
    answer = client.post(
        "/v1/jobs",
        params={"parameters": '{"max_segments": 5}'},
        data={"parameters": '{"max_segments": 6}'},
        files={"mesh": ("mesh.off", b"abc")},
    )
    problem(answer, 422, "invalid_parameters")


def test_a_refused_body_leaves_no_files(client: httpx.Client, settings: Settings) -> None:
    problem(raw(client, b"x" * 200_001), 413, "too_large")
    problem(client.post("/v1/jobs", content=iter([b"x" * 100_000] * 3)), 413, "too_large")
    problem(raw(client, b""), 422, "invalid_mesh")
    problem(raw(client, b"abc", "/v1/jobs?format=exe"), 415, "unsupported_media_type")
    assert list((settings.data_dir / "incoming").iterdir()) == []
