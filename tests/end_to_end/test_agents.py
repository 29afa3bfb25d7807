"""`cleave mcp` with a service of its own, as an agent starts it."""

import asyncio
import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from mcp import Client, StdioServerParameters, stdio_client
from mcp_types import TextContent

from helpers.waiting import wait_until
from service.samples import sample_ply


def running_in(folder: Path) -> list[int]:
    """Return the processes that have a data folder in their command line or environment."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                text = (entry / "cmdline").read_bytes() + (entry / "environ").read_bytes()
            except OSError:
                continue
            found += [int(entry.name)] if str(folder).encode() in text else []
    return found


def test_an_agent_needs_no_service_that_runs(tmp_path: Path) -> None:
    mesh, target, data = tmp_path / "stool.ply", tmp_path / "stool.glb", tmp_path / "data"
    mesh.write_bytes(sample_ply("stool"))
    # Settings of another installation, which this one must not join.
    environment = {**os.environ, "CLEAVE_AUTH": "required", "CLEAVE_REDIS_URL": "redis://127.0.0.1:1"}
    words = ["-m", "service.commands", "mcp", "--data-dir", str(data)]

    async def story() -> list[str]:
        server = StdioServerParameters(command=sys.executable, args=words, env=environment)
        async with Client(stdio_client(server)) as agent:

            async def answer(tool: str, **arguments: object) -> dict[str, Any]:
                result = await agent.call_tool(tool, arguments)
                assert not result.is_error, result.content
                assert isinstance(result.content[0], TextContent)
                document: dict[str, Any] = json.loads(result.content[0].text)
                return document

            job = await answer("segment", path=str(mesh))
            while job["status"] not in ("succeeded", "failed"):
                job = await answer("job_status", job_id=job["job_id"], wait_s=45)
            await answer("name_parts", job_id=job["job_id"], names={"0": "seat", "1": "leg"})
            listed = await answer("list_parts", job_id=job["job_id"])
            await answer("download", job_id=job["job_id"], result="glb", path=str(target))
            return [part["name"] for part in listed["parts"]]

    names = asyncio.run(story())
    assert names[:2] == ["seat", "leg"]
    assert b'"seat"' in target.read_bytes()
    wait_until(lambda: running_in(data) == [], within_s=30)


@pytest.mark.parametrize("is_connected", [False, True])
@pytest.mark.parametrize(("number", "status"), [(signal.SIGTERM, 0), (signal.SIGINT, 130)])
def test_a_signal_ends_it_and_its_service(
    tmp_path: Path, number: signal.Signals, status: int, is_connected: bool
) -> None:
    words = [sys.executable, "-m", "service.commands", "mcp"]
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment) as process:
        wait_until(lambda: [*tmp_path.glob("cleave-mcp-*/serve.lock")] != [], within_s=60)
        if is_connected:
            assert process.stdin is not None
            assert process.stdout is not None
            process.stdin.write(b'{"jsonrpc": "2.0", "id": 1, "method": "ping"}\n')
            process.stdin.flush()
            assert b'"id":1' in process.stdout.readline()
        process.send_signal(number)
        assert process.wait(30) == status
    assert [*tmp_path.iterdir()] == []
    wait_until(lambda: running_in(tmp_path / "cleave-mcp-") == [], within_s=30)
