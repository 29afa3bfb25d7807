"""Uploads: streamed, capped, and without a trace where they break off; what a client calls its file is never a path."""

import asyncio
import io
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import httpx
import hypothesis
import pytest
from hypothesis import strategies as st
from starlette.requests import ClientDisconnect, Request

from cleave.settings import Settings
from helpers.api import problem, traces
from segcore.errors import InvalidParameters
from service.problems import Problem
from service.submit.form import FormReader
from service.submit.request import file_label, mesh_format, parse_parameters, receive_mesh
from worker.jobs.store.store import JobStore

BOUNDARY = "----boundary"
LIMITED = Settings(max_upload_bytes=10_000, upload_idle_s=0.2)
CONTENT_TYPE = f"multipart/form-data; boundary={BOUNDARY}"


def part(name: str, content: bytes, extra: str = "") -> bytes:
    head = f'--{BOUNDARY}\r\nContent-Disposition: form-data; name="{name}"{extra}\r\n\r\n'
    return head.encode() + content + b"\r\n"


def form(*parts: bytes) -> bytes:
    return b"".join(parts) + f"--{BOUNDARY}--\r\n".encode()


def post(client: httpx.Client, body: bytes | Iterator[bytes], content_type: str = CONTENT_TYPE) -> tuple[int, str]:
    answer = client.post("/v1/jobs", content=body, headers={"Content-Type": content_type})
    return answer.status_code, answer.json().get("code", "")


@pytest.mark.parametrize("step", [1, 2, 7, 64, 1000])
def test_a_form_means_the_same_however_it_is_cut_up(store: JobStore, step: int) -> None:
    content = b"\r\n--" + bytes(range(256)) + f"\r\n--{BOUNDARY[:-1]}\r\n".encode() * 3
    body = form(part("parameters", b'{"seed": 1}'), part("mesh", content, '; filename="hand.OFF"'))
    with store.spool.begin_upload() as upload:
        reader = FormReader(BOUNDARY.encode(), lambda: upload, 10_000)
        for start in range(0, len(body), step):
            reader.feed(body[start : start + step])
        result = reader.finish()
        assert (upload.folder / "mesh").read_bytes() == content
    assert bytes(result.parameters) == b'{"seed": 1}'
    assert [mesh.file_name for mesh in result.meshes] == ["hand.OFF"]


@hypothesis.settings(
    max_examples=200, deadline=None, suppress_health_check=[hypothesis.HealthCheck.function_scoped_fixture]
)
@hypothesis.given(
    st.lists(
        st.sampled_from([b"\r\n", b"--" + BOUNDARY.encode(), b"--", b"name=mesh", b": ", b"\0"])
        | st.binary(max_size=40)
    )
)
def test_whatever_is_sent_is_a_form_or_a_problem(store: JobStore, pieces: list[bytes]) -> None:
    with store.spool.begin_upload() as upload:
        reader = FormReader(BOUNDARY.encode(), lambda: upload, 10_000)
        with suppress(Problem):
            for piece in [form(part("mesh", b"abc"))[:40], *pieces]:
                reader.feed(piece)
            reader.finish()


@pytest.mark.parametrize(
    ("body", "code"),
    [
        (form(part("mesh", b"abc"))[:-20], "malformed_request"),
        (form(), "malformed_request"),
        (form(part("parameters", b"{}")), "malformed_request"),
        (form(part("file", b"abc")), "malformed_request"),
        (form(part("mesh", b"abc"), part("mesh", b"abc")), "malformed_request"),
        (b"\x00" * 1000, "malformed_request"),
        (f"--{BOUNDARY}\r\n\r\nabc\r\n--{BOUNDARY}--\r\n".encode(), "malformed_request"),
        (form(part("mesh", b"")), "invalid_mesh"),
        (form(part("mesh", b"x" * 200_001)), "too_large"),
        (form(part("mesh", b"abc"), part("parameters", b" " * 20_000)), "too_large"),
        (form(part("mesh", b"abc"), part("parameters", b"{")), "invalid_parameters"),
    ],
)
def test_a_form_that_cannot_be_used_is_refused_and_leaves_nothing(
    client: httpx.Client, settings: Settings, body: bytes, code: str
) -> None:
    status, found = post(client, body)
    assert found == code
    assert 400 <= status < 500
    assert traces(settings.data_dir) == []
    assert list((settings.data_dir / "incoming").iterdir()) == []


@pytest.mark.parametrize(
    ("content_type", "expected"),
    [
        ("application/json", (415, "unsupported_media_type")),
        ("application/x-www-form-urlencoded", (415, "unsupported_media_type")),
        ("multipart/form-data", (400, "malformed_request")),
        (f"multipart/form-data; boundary={'b' * 71}", (400, "malformed_request")),
    ],
)
def test_a_body_of_another_kind_is_refused(client: httpx.Client, content_type: str, expected: tuple[int, str]) -> None:
    assert post(client, form(part("mesh", b"abc")), content_type) == expected


def test_an_undeclared_length_is_limited_while_it_streams(client: httpx.Client, settings: Settings) -> None:
    sent = 0

    def endless() -> Iterator[bytes]:
        nonlocal sent
        yield part("mesh", b"")[:-2]
        for _ in range(100):
            sent += 1
            yield b"x" * 10_000

    assert post(client, endless()) == (413, "too_large")
    assert traces(settings.data_dir) == []


def request_of(chunks: list[bytes], **headers: str) -> Request:
    """A request whose client goes away after these chunks."""
    messages = [{"type": "http.request", "body": chunk, "more_body": True} for chunk in chunks]
    messages.append({"type": "http.disconnect"})
    source = iter(messages)

    async def receive() -> dict[str, object]:
        return next(source)

    raw = [(name.replace("_", "-").encode(), value.encode()) for name, value in headers.items()]
    return Request({"type": "http", "method": "POST", "headers": raw}, receive)


def test_a_client_that_goes_away_leaves_nothing(store: JobStore, tmp_path: Path) -> None:
    request = request_of([part("mesh", b"half of a mesh")], content_type=CONTENT_TYPE, transfer_encoding="chunked")

    async def receive() -> None:
        with store.spool.begin_upload() as upload:
            await receive_mesh(request, LIMITED, lambda: upload)

    with pytest.raises(ClientDisconnect):
        asyncio.run(receive())
    assert list((tmp_path / "data" / "incoming").iterdir()) == []


@pytest.mark.parametrize("length", ["10000000", "9" * 5000])
def test_a_declared_length_is_refused_before_the_body_is_read(store: JobStore, length: str) -> None:
    request = request_of([], content_type=CONTENT_TYPE, content_length=length)

    async def receive() -> None:
        with store.spool.begin_upload() as upload:
            await receive_mesh(request, LIMITED, lambda: upload)

    with pytest.raises(Problem, match="larger than"):
        asyncio.run(receive())


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
def test_a_file_name_is_a_hint_at_the_format_and_nothing_else(name: str | None, expected: str | None) -> None:
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
def test_parameters_that_cannot_be_used_are_refused(client: httpx.Client, text: bytes) -> None:
    with pytest.raises(InvalidParameters):
        parse_parameters(text)
    status, code = post(client, form(part("mesh", b"abc"), part("parameters", text)))
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


def test_parameters_can_stand_in_the_query(client: httpx.Client) -> None:
    answer = client.post("/v1/jobs", content=b"abc", params={"parameters": '{"seed": 9}'})
    assert answer.json()["parameters"]["seed"] == 9
    refused = client.post("/v1/jobs", content=b"abc", params={"parameters": '{"seed": -9}'})
    problem(refused, 422, "invalid_parameters")


def test_a_raw_body_is_limited_and_leaves_nothing(client: httpx.Client, settings: Settings) -> None:
    problem(raw(client, b"x" * 200_001), 413, "too_large")
    problem(client.post("/v1/jobs", content=iter([b"x" * 100_000] * 3)), 413, "too_large")
    problem(raw(client, b""), 422, "invalid_mesh")
    problem(raw(client, b"abc", "/v1/jobs?format=exe"), 415, "unsupported_media_type")
    assert list((settings.data_dir / "incoming").iterdir()) == []


def test_a_request_without_a_body_is_told_so(store: JobStore) -> None:
    request = request_of([], content_type=CONTENT_TYPE)

    async def receive() -> None:
        with store.spool.begin_upload() as upload:
            await receive_mesh(request, LIMITED, lambda: upload)

    with pytest.raises(Problem, match="no body") as refused:
        asyncio.run(receive())
    assert refused.value.code == "length_required"


def slow_request(pause_s: float) -> Request:
    """A request that sends a byte after every pause, for ever."""

    async def receive() -> dict[str, object]:
        await asyncio.sleep(pause_s)
        return {"type": "http.request", "body": b"x", "more_body": True}

    return Request({"type": "http", "method": "POST", "headers": [(b"transfer-encoding", b"chunked")]}, receive)


@pytest.mark.parametrize("pause_s", [60.0, 0.01])
def test_a_client_that_sends_hardly_anything_is_given_up(store: JobStore, tmp_path: Path, pause_s: float) -> None:
    async def receive() -> None:
        with store.spool.begin_upload() as upload:
            await receive_mesh(slow_request(pause_s), LIMITED, lambda: upload)

    with pytest.raises(Problem, match="slow") as refused:
        asyncio.run(receive())
    assert refused.value.code == "too_slow"
    assert list((tmp_path / "data" / "incoming").iterdir()) == []
