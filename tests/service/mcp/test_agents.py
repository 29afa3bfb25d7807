"""A whole story of an agent, with the client of the SDK: segment, look, click, split, name, download."""

import ast
import asyncio
import base64
import json
import os
import re
import sys
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from pathlib import Path
from typing import Any

import httpx
import httpx2
import numpy as np
import pytest
import trimesh
from mcp import Client, StdioServerParameters, stdio_client
from mcp.client.streamable_http import streamable_http_client
from mcp_types import CallToolResult, EmbeddedResource, ImageContent, TextContent

from cleave.settings import Settings
from helpers.documents import read
from helpers.servers import serving, working
from service.keys import key_digest, new_key
from service.samples import sample_ply
from worker.jobs.store.store import JobStore

ANNA, BORIS = new_key(), new_key()
KEYS = f"anna:{key_digest(ANNA)}, boris:{key_digest(BORIS)}"
Agent = Client


@pytest.fixture
def guarded(settings: Settings, store: JobStore) -> Iterator[httpx.Client]:
    """A service with keys, below a path."""
    settings = settings.model_copy(update={"api_keys": KEYS, "root_path": "/cleave", "max_upload_bytes": 2_000_000})
    with serving(settings) as client, working(store, settings):
        client.headers["Authorization"] = f"Bearer {ANNA}"
        yield client


@asynccontextmanager
async def over_http(client: httpx.Client, key: str, path: str = "/mcp", **more: str) -> AsyncIterator[Any]:
    url = f"{str(client.base_url).rstrip('/')}{path}"
    async with (
        httpx2.AsyncClient(headers={"Authorization": f"Bearer {key}", **more}, timeout=60) as http,
        streamable_http_client(url, http_client=http) as streams,
    ):
        yield streams


def over_stdio(client: httpx.Client) -> AbstractAsyncContextManager[Any]:
    environment = {**os.environ, "CLEAVE_API_KEY": ANNA}
    words = ["-m", "service.commands", "mcp", "--server", str(client.base_url)]
    return stdio_client(StdioServerParameters(command=sys.executable, args=words, env=environment))


def run(
    transport: AbstractAsyncContextManager[Any], story: Callable[[Agent], Awaitable[Any]], mode: str = "auto"
) -> Any:
    """Run a story with an agent that is connected."""

    async def connected() -> Any:
        async with Client(transport, mode=mode) as agent:
            return await story(agent)

    return asyncio.run(connected())


async def answer(agent: Agent, tool: str, **arguments: object) -> dict[str, Any]:
    """Call a tool and return its JSON."""
    result = await agent.call_tool(tool, arguments)
    assert not result.is_error, result.content
    return text_of(result)


def text_of(result: CallToolResult) -> dict[str, Any]:
    texts = [content.text for content in result.content if isinstance(content, TextContent)]
    assert len(texts) == 1
    document: dict[str, Any] = json.loads(texts[0])
    return document


async def refusal(agent: Agent, tool: str, **arguments: object) -> str:
    """Call a tool that refuses and return its sentence."""
    result = await agent.call_tool(tool, arguments)
    assert result.is_error
    assert isinstance(result.content[0], TextContent)
    return result.content[0].text


async def look_click_and_edit(agent: Agent, job: dict[str, Any]) -> str:
    """Edit the parts of a job that has succeeded, checking every answer; return the id of the job."""
    assert job["status"] == "succeeded", job
    job_id: str = job["job_id"]
    made = await answer(agent, "set_level", job_id=job_id, parts=3)
    assert (made["revision"], len(made["parts"])) == (1, 3)

    looked = await agent.call_tool("look", {"job_id": job_id, "side": "front", "size": 300})
    picture = next(content for content in looked.content if isinstance(content, ImageContent))
    png = base64.b64decode(picture.data)
    assert png.startswith(b"\x89PNG")
    assert (picture.mime_type, png[16:24]) == ("image/png", (300).to_bytes(4) * 2)
    view = text_of(looked)
    assert {part["number"] for part in view["parts"]} | set(view["hidden"]) == {0, 1, 2}

    camera = {"job_id": job_id, "side": "front", "size": 300}
    for part in view["parts"]:
        assert (await answer(agent, "part_at", at=[part["x"], part["y"]], **camera))["part"] == part["number"]
    assert (await answer(agent, "part_at", at=[0, 0], **camera))["part"] is None

    largest = max(view["parts"], key=lambda part: part["pixels"])
    line = [[0, largest["y"]], [299, largest["y"]]]
    assert len((await answer(agent, "split_part", part=largest["number"], line=line, **camera))["parts"]) == 4
    assert len((await answer(agent, "restore_revision", job_id=job_id, revision=1))["parts"]) == 3
    found = await answer(agent, "find_part", inside=[[largest["x"], largest["y"]]], **camera)
    assert found["what"] == "part from marks to a new part"
    await answer(agent, "restore_revision", job_id=job_id, revision=1)
    assert len((await answer(agent, "merge_parts", job_id=job_id, parts=[0, 1]))["parts"]) == 2
    await answer(agent, "name_parts", job_id=job_id, names={"0": "body", "1": "head"})
    listed = await answer(agent, "list_parts", job_id=job_id)
    assert [part["name"] for part in listed["parts"]] == ["body", "head"]
    assert "no part 9" in (await refusal(agent, "merge_parts", job_id=job_id, parts=[0, 9])).lower()
    return job_id


def check_stored(client: httpx.Client, job_id: str, labels: bytes) -> None:
    """Check that labels as .seg, and the names of the story, are those that the API has."""
    stored = client.get(f"/v1/jobs/{job_id}/labels", params={"revision": "latest", "format": "npy"}).content
    of_faces = np.frombuffer(stored[-4 * len(labels.split()) :], dtype="<i4")
    assert [int(label) for label in labels.split()] == of_faces.tolist()
    parts = client.get(f"/v1/jobs/{job_id}/revisions/latest").json()["parts"]
    assert [part["name"] for part in parts] == ["body", "head"]


def test_an_agent_over_http_names_the_parts_of_a_mesh_that_it_sends(guarded: httpx.Client) -> None:
    async def story(agent: Agent) -> tuple[str, list[Any], str]:
        mesh = base64.b64encode(sample_ply("pawn")).decode()
        job_id = await look_click_and_edit(agent, await answer(agent, "segment", file_name="a.ply", mesh_base64=mesh))
        got = await agent.call_tool("download", {"job_id": job_id, "result": "seg", "embed": True})
        assert "more than 8 MiB" in await refusal(agent, "segment", file_name="a.obj", mesh_text="#" * (8 * 2**20 + 1))
        assert "empty" in await refusal(agent, "segment", file_name="../..", mesh_text="")
        assert "not base64" in await refusal(agent, "segment", file_name="a.obj", mesh_base64="?")
        return job_id, got.content, (await answer(agent, "list_jobs"))["jobs"][0]["job_id"]

    job_id, content, newest = run(over_http(guarded, ANNA), story)
    assert newest == job_id
    path = json.loads(content[0].text)["path"]
    assert path.startswith(f"/cleave/v1/jobs/{job_id}/labels?")
    assert isinstance(content[1], EmbeddedResource)
    labels = base64.b64decode(content[1].resource.blob)  # type: ignore[union-attr]
    assert guarded.get(path).content == labels
    check_stored(guarded, job_id, labels)

    async def where(agent: Agent) -> str:
        return str((await answer(agent, "download", job_id=job_id, result="glb"))["path"])

    behind_proxy = over_http(guarded, ANNA, **{"X-Forwarded-Prefix": "/3d"})
    assert run(behind_proxy, where) == f"/3d/v1/jobs/{job_id}/model.glb?revision=latest"

    async def other(agent: Agent) -> tuple[list[Any], str]:
        return (await answer(agent, "list_jobs"))["jobs"], await refusal(agent, "look", job_id=job_id)

    jobs, sentence = run(over_http(guarded, BORIS, "/cleave/mcp"), other)
    assert jobs == []
    assert "There is no job with this id" in sentence


def test_an_agent_over_stdio_names_the_parts_of_a_file(guarded: httpx.Client, tmp_path: Path) -> None:
    mesh, target = tmp_path / "pawn.ply", tmp_path / "pawn.seg"
    mesh.write_bytes(sample_ply("pawn"))

    async def story(agent: Agent) -> str:
        job_id = await look_click_and_edit(agent, await answer(agent, "segment", path=str(mesh)))
        saved = await answer(agent, "download", job_id=job_id, result="seg", path=str(target))
        assert saved["bytes"] == target.stat().st_size
        assert "exists" in await refusal(agent, "download", job_id=job_id, result="seg", path=str(target))
        assert "No such file" in await refusal(agent, "segment", path=str(tmp_path / "none.off"))
        return job_id

    check_stored(guarded, run(over_stdio(guarded), story), target.read_bytes())


def test_the_calls_of_the_guide_name_the_parts_of_a_stool(guarded: httpx.Client, tmp_path: Path) -> None:
    (tmp_path / "stool.ply").write_bytes(sample_ply("stool"))
    table = re.findall(r"^\| `(\w+\(.*\))` \|", read(Path("docs/how-to/agents.md")), re.MULTILINE)
    assert [line.partition("(")[0] for line in table] == ["segment", "look", "name_parts", "download"]

    async def story(agent: Agent) -> list[str]:
        job_id, names = "", []
        for line in table:
            written = line.replace("/home/anna", str(tmp_path)).replace("job_id=...", f"job_id={job_id!r}")
            call = ast.parse(written, mode="eval").body
            assert isinstance(call, ast.Call)
            arguments = {one.arg: ast.literal_eval(one.value) for one in call.keywords}
            result = await agent.call_tool(line.partition("(")[0], arguments)
            assert not result.is_error, result.content
            job_id = job_id or text_of(result)["job_id"]
            names = list(arguments.get("names", {}).values()) or names
        return names

    names = run(over_stdio(guarded), story)
    assert len(names) == 5
    nodes = trimesh.load_scene(tmp_path / "stool.glb").graph.nodes_geometry
    assert set(nodes) == set(names)


def test_without_a_key_there_are_no_tools(guarded: httpx.Client) -> None:
    for headers in ({"Authorization": ""}, {"Authorization": "Bearer wrong"}):
        refused = guarded.post("/mcp", json={}, headers=headers)
        assert (refused.status_code, refused.json()["code"]) == (401, "unauthorized")
    refused = guarded.post("/mcp", content=b" " * (12 * 2**20 + 1))
    assert (refused.status_code, refused.json()["code"]) == (413, "too_large")
    assert guarded.get("/mcp").status_code == 405


def test_a_service_without_the_optional_dependency_names_it(
    client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mcp.server.transport_security", None)
    refused = client.post("/mcp", json={})
    assert refused.status_code == 404
    assert "cleave-mesh[mcp]" in refused.json()["detail"]


@pytest.mark.parametrize("mode", ["auto", "legacy"])  # with the handshake of protocols before 2026
def test_every_tool_has_a_description_for_a_model(client: httpx.Client, mode: str) -> None:
    async def story(agent: Agent) -> None:
        tools = (await agent.list_tools()).tools
        assert len(tools) == 13
        for tool in tools:
            assert len(tool.description or "") > 80, tool.name
            assert "call" not in tool.input_schema["properties"], tool.name

    run(over_http(client, "none"), story, mode)
