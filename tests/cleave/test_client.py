"""The clients: both do the same, refusals are errors with a code, and retries are limited."""

import asyncio
from collections.abc import Callable
from pathlib import Path

import httpx
import numpy as np
import pytest

import cleave.client
import cleave.documents
import cleave.errors
from cleave.client import AsyncClient, Client
from cleave.client.documents import Job
from cleave.client.errors import JobEnded, RequestRefused, ServerUnreachable
from helpers.files.written import mesh_bytes
from helpers.jobs import sphere
from segcore.shapes import burr


@pytest.fixture
def mesh(tmp_path: Path) -> Path:
    path = tmp_path / "ball.off"
    path.write_bytes(sphere(12))
    return path


def test_a_mesh_becomes_labels_in_one_call(url: str, mesh: Path) -> None:
    with Client(url) as client:
        parts = client.segment(mesh, segments=4)
        assert (parts.segments, len(parts.labels), parts.labels.dtype) == (4, parts.job.faces, np.int32)
        assert set(parts.labels.tolist()) == {0, 1, 2, 3}
        assert np.array_equal(client.labels(parts.job, 4).labels, parts.labels)
        automatic = client.labels(parts.job)
        assert automatic.segments == parts.job.automatic_segments
        assert client.segment(mesh.read_bytes(), format="off").segments == automatic.segments


def test_the_files_of_a_model_are_sent_with_it(url: str, tmp_path: Path) -> None:
    (tmp_path / "ball.obj").write_bytes(mesh_bytes(burr(2).mesh, "obj"))
    (tmp_path / 'a "b".mtl').write_text("newmtl red\n")
    (tmp_path / "images").mkdir()
    (tmp_path / "images" / "empty.png").write_bytes(b"")
    files = [tmp_path / 'a "b".mtl', tmp_path / "images" / "empty.png"]
    by_name = {'a "b".mtl': files[0], "images/empty.png": files[1]}

    async def job_of_async_client() -> Job:
        async with AsyncClient(url) as client:
            return await client.submit(tmp_path / "ball.obj", companions=by_name, recompute=True)

    with Client(url) as client:
        job = client.submit(tmp_path / "ball.obj", companions=files)
        assert client.wait(job.id).status == "succeeded"
        assert job.file_name == "ball.obj"
        other = asyncio.run(job_of_async_client())
        hashes = {one.document["input"]["sha256"] for one in (job, other)}
        assert len(hashes) == 1
        with pytest.raises(ValueError, match="give its path"):
            client.submit(b"OFF", companions=files)


def test_a_granularity_can_replace_a_number_of_segments(url: str, mesh: Path) -> None:
    with Client(url) as client:
        parts = client.segment(mesh, granularity=1.0)
        assert parts.segments == parts.job.max_segments == len(set(parts.labels.tolist()))
        assert client.labels(parts.job, granularity=0.5).segments == parts.job.automatic_segments
        with pytest.raises(RequestRefused, match="not both"):
            client.labels(parts.job, 3, granularity=0.5)


def test_a_job_can_be_followed_fetched_and_deleted(url: str, mesh: Path, tmp_path: Path) -> None:
    with Client(url) as client:
        job = client.submit(mesh, parameters={"max_segments": 5}, idempotency_key="one")
        assert client.submit(mesh, parameters={"max_segments": 5}, idempotency_key="one").id == job.id
        job = client.wait(job.id)
        assert (job.status, job.file_name, job.max_segments) == ("succeeded", "ball.off", 5)
        assert job.limit_reached is True
        assert [other.id for other in client.jobs("succeeded")] == [job.id]
        assert client.hierarchy(job.id)["max_segments"] == 5
        client.download(job.id, "model.obj", tmp_path / "parts.obj", segments=3, name=["0:ball", "2:arm"])
        assert "o arm" in (tmp_path / "parts.obj").read_text()
        client.download(job.id, "model.glb", tmp_path / "parts.glb", segments=3)
        assert (tmp_path / "parts.glb").read_bytes().startswith(b"glTF")
        assert client.content(job.id, "model.glb", segments=3) == (tmp_path / "parts.glb").read_bytes()
        client.delete(job.id)
        with pytest.raises(RequestRefused, match="deleted") as refused:
            client.job(job.id)
        assert (refused.value.status, refused.value.code) == (410, "job_deleted")
        with pytest.raises(RequestRefused):
            client.download(job.id, "model.glb", tmp_path / "other.glb")
    assert {path.name for path in tmp_path.iterdir() if path.is_file()} == {"ball.off", "parts.obj", "parts.glb"}


def test_the_asyncio_client_does_the_same(url: str, mesh: Path, tmp_path: Path) -> None:
    async def run() -> None:
        async with AsyncClient(url) as client:
            parts, job = await asyncio.gather(client.segment(mesh, segments=4), client.submit(mesh))
            job = await client.wait(job.id)
            assert (await client.labels(job, granularity=1.0)).segments == job.max_segments
            assert np.array_equal((await client.labels(job, 4)).labels, parts.labels)
            assert {other.id async for other in client.jobs()} == {job.id, parts.job.id}
            await client.download(job.id, "labels", tmp_path / "labels.npy", format="npy", segments=4)
            assert np.array_equal(np.load(tmp_path / "labels.npy"), parts.labels)
            content = await client.content(job.id, "labels", format="npy", segments=4)
            assert content == (tmp_path / "labels.npy").read_bytes()
            assert (await client.hierarchy(job.id))["max_segments"] == job.max_segments
            await client.delete(job.id)
            with pytest.raises(RequestRefused):
                await client.cancel(job.id)

    asyncio.run(run())


def test_a_job_without_a_result_says_why(url: str) -> None:
    with Client(url) as client, pytest.raises(JobEnded, match="convert it") as ended:
        client.segment(b"Kaydara FBX Binary  \0 this is no mesh")
    assert ended.value.job.status == "failed"


def busy(times: int, status: int = 503) -> tuple[Callable[[httpx.Request], httpx.Response], list[httpx.Request]]:
    """A server that is busy a number of times and then answers that there is no such job."""
    seen: list[httpx.Request] = []

    def answer(request: httpx.Request) -> httpx.Response:
        seen.append(request)
        if len(seen) <= times:
            return httpx.Response(status, headers={"Retry-After": "0"}, json={"code": "busy", "detail": "Busy."})
        return httpx.Response(404, json={"code": "job_not_found", "detail": "There is none."})

    return answer, seen


@pytest.mark.parametrize(("times", "tries", "code"), [(0, 1, "job_not_found"), (2, 3, "job_not_found"), (9, 3, "busy")])
def test_a_request_to_a_busy_server_is_repeated_a_few_times(mesh: Path, times: int, tries: int, code: str) -> None:
    answer, seen = busy(times)
    with Client(retries=2, transport=httpx.MockTransport(answer)) as client, pytest.raises(RequestRefused) as refused:
        client.submit(mesh)
    assert refused.value.code == code
    assert len(seen) == tries
    assert len({request.headers["Idempotency-Key"] for request in seen}) == 1


def test_the_response_of_another_server_is_reported_as_such() -> None:
    transport = httpx.MockTransport(lambda _: httpx.Response(404, text="<html>"))
    with Client(transport=transport) as client, pytest.raises(RequestRefused, match="is this a Cleave server"):
        client.job("1")


def test_an_unreachable_server_has_its_own_error() -> None:
    with Client("http://127.0.0.1:1", retries=1) as client, pytest.raises(ServerUnreachable, match="is the server"):
        client.job("1")


def test_errors_and_documents_can_be_imported_from_the_earlier_modules() -> None:
    for module in (cleave.errors, cleave.documents):
        for name in module.__all__:
            assert getattr(module, name) is getattr(cleave.client, name)


def test_the_api_key_is_sent() -> None:
    answer, seen = busy(0)
    with Client(api_key="k", transport=httpx.MockTransport(answer)) as client, pytest.raises(RequestRefused):
        client.job("1")
    assert seen[0].headers["Authorization"] == "Bearer k"


def test_parts_are_edited_and_labels_replaced(url: str, mesh: Path, tmp_path: Path) -> None:
    merge = [{"op": "merge", "parts": [0, 2]}]

    async def restored(job_id: str) -> list[int]:
        async with AsyncClient(url) as client:
            await client.edit(job_id, [{"op": "restore", "revision": 1}])
            return [one.number for one in await client.revisions(job_id)]

    with Client(url) as client:
        job = client.segment(mesh, segments=4).job
        shown = client.edit(job.id, merge, level={"segments": 4}, preview=True)
        assert shown.revision is None
        edited = client.edit(job.id, [*merge, {"op": "name", "part": 0, "name": "body"}], level={"segments": 4})
        assert edited.revision is not None
        assert (edited.revision.number, edited.parts[0].name, len(edited.parts)) == (1, "body", 3)
        labels = client.labels(job, revision="latest").labels
        assert client.put_labels(job.id, np.zeros_like(labels)).parts[0].faces == len(labels)
        assert client.labels(job, revision=2).segments == 1
        assert asyncio.run(restored(job.id)) == [3, 2, 1]
        assert np.array_equal(client.labels(job, revision=3).labels, labels)
        client.download(job.id, "model.glb", tmp_path / "a.glb", revision="latest")
        assert b'"body"' in (tmp_path / "a.glb").read_bytes()
        with pytest.raises(RequestRefused) as refused:
            client.edit(job.id, merge, base=1)
        assert refused.value.code == "revision_conflict"


def test_an_edit_in_the_queue_is_waited_for() -> None:
    revision = {
        "number": 1,
        "parent": 0,
        "made_at": "2026-01-01T00:00:00Z",
        "made_by": None,
        "what": "smooth the borders",
        "segments": 1,
    }
    part = {"name": "body", "color": "#102030", "class": "", "locked": False, "faces": 4}
    states = iter([{"error": None, "revision": None}, {"error": None, "revision": revision}])
    failed = {"error": {"code": "revision_conflict", "message": "Somebody was faster."}, "revision": None}
    seen: list[str] = []

    def answer(request: httpx.Request) -> httpx.Response:
        seen.append(request.url.path)
        match request.method, request.url.path:
            case "POST", _:
                return httpx.Response(202, headers={"Location": "/cleave/v1/jobs/a/edits/b"}, json={})
            case _, "/cleave/v1/jobs/a/edits/b":
                return httpx.Response(200, json=next(states, failed))
        return httpx.Response(200, json={**revision, "parts": [part]})

    with Client("http://localhost/cleave", transport=httpx.MockTransport(answer)) as client:
        edited = client.edit("a", [{"op": "smooth"}], base=0)
        assert edited.revision is not None
        assert (edited.revision.number, edited.parts[0].name) == (1, "body")
        assert seen[1:] == ["/cleave/v1/jobs/a/edits/b"] * 2 + ["/cleave/v1/jobs/a/revisions/1"]
        with pytest.raises(RequestRefused, match="faster"):
            client.edit("a", [{"op": "smooth"}], base=0)
