"""The parser of forms."""

from contextlib import suppress

import httpx
import hypothesis
import pytest
from hypothesis import strategies as st

from cleave.settings import Settings
from helpers.api import problem, traces
from helpers.uploads import BOUNDARY, form, part, post_form
from service.problems import Problem
from service.submit.form import FormReader
from worker.jobs.store.store import JobStore


@pytest.mark.parametrize("step", [1, 2, 7, 64, 1000])
def test_a_form_does_not_depend_on_its_chunks(store: JobStore, step: int) -> None:
    content = b"\r\n--" + bytes(range(256)) + f"\r\n--{BOUNDARY[:-1]}\r\n".encode() * 3
    body = form(part("parameters", b'{"seed": 1}'), part("mesh", content, '; filename="hand.OFF"'))
    with store.spool.begin_upload() as upload:
        reader = FormReader(BOUNDARY.encode(), lambda: upload, 10_000, 1)
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
def test_arbitrary_bytes_are_a_form_or_a_problem(store: JobStore, pieces: list[bytes]) -> None:
    with store.spool.begin_upload() as upload:
        reader = FormReader(BOUNDARY.encode(), lambda: upload, 10_000, 1)
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
        (form(part("mesh", b"abc"), part("mesh", b"abc")), "invalid_file_set"),
        (b"\x00" * 1000, "malformed_request"),
        (f"--{BOUNDARY}\r\n\r\nabc\r\n--{BOUNDARY}--\r\n".encode(), "malformed_request"),
        (form(part("mesh", b"")), "invalid_mesh"),
        (form(part("mesh", b"x" * 200_001)), "too_large"),
        (form(part("mesh", b"abc"), part("parameters", b" " * 20_000)), "too_large"),
        (form(part("mesh", b"abc"), part("parameters", b"{")), "invalid_parameters"),
    ],
)
def test_an_invalid_form_is_refused_and_leaves_no_files(
    client: httpx.Client, settings: Settings, body: bytes, code: str
) -> None:
    status, found = post_form(client, body)
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
def test_a_body_in_another_format_is_refused(
    client: httpx.Client, content_type: str, expected: tuple[int, str]
) -> None:
    assert post_form(client, form(part("mesh", b"abc")), content_type) == expected


def test_a_form_with_two_meshes_is_refused_with_a_hint_at_batches(client: httpx.Client) -> None:
    files = [("mesh", ("a.off", b"abc")), ("mesh", ("b.off", b"abc"))]
    body = problem(client.post("/v1/jobs", files=files), 422, "invalid_file_set")
    assert "/v1/batches" in str(body["detail"])
