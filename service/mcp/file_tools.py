"""Tools that send meshes and receive results: as files of this machine, or within the messages of a remote agent."""

import asyncio
import base64
import binascii
import tempfile
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Annotated, TypeAlias

from mcp.server.mcpserver.exceptions import ToolError
from mcp_types import BlobResourceContents, EmbeddedResource, TextContent
from pydantic import Field

from segcore.io import neighbours_of
from service.commands.server_results import RESULTS, ServerResult
from service.mcp.calls import Call, Connect, JobId, text_of
from service.mcp.job_tools import LONGEST_WAIT_S, job_text

MOST_SENT_BYTES = 8 * 2**20  # of a mesh within a message; set by hand
_MOST_RETURNED_BYTES = 2**20  # of a result within a message; set by hand
_MODELS = [name for name in RESULTS if name != "png"]
Result: TypeAlias = Annotated[
    str,
    Field(
        description=f"What to get: {', '.join(_MODELS)}. seg and npy are the number of the part of every face, in the "
        "order of the file; json is the tree of cuts; glb has a named node per part, kept the input file with "
        "everything that it had; zip has a closed mesh per part as STL."
    ),
]


@dataclass(frozen=True, slots=True)
class LocalFileTools:
    """Tools of an agent on the machine of the files."""

    connect: Connect

    async def segment(
        self,
        call: Call,
        path: Annotated[str, Field(description="A mesh file: OFF, STL, PLY, OBJ, GLB, glTF or 3MF; ~ is the home.")],
    ) -> str:
        """Cut a 3D mesh into the parts that a person would name. Returns the job, whose id all other tools need.

        Files that the mesh refers to (materials, buffers, pictures) are sent along if they are in its folder. Waits up
        to 45 seconds; a larger mesh goes on, then call job_status with wait_s.
        """
        mesh = Path(path).expanduser()
        companions = await asyncio.to_thread(neighbours_of, mesh)
        async with self.connect(call) as client:
            job = await client.submit(mesh, companions=companions)
            return await job_text(client, job.id, LONGEST_WAIT_S)

    async def download(
        self,
        call: Call,
        job_id: JobId,
        result: Result,
        path: Annotated[str, Field(description="The file to write; it must not exist yet.")],
    ) -> str:
        """Save the parts, with their names, in a file. Returns its path and size in bytes."""
        wanted, target = _result(result), Path(path).expanduser()
        if target.exists():
            raise ToolError(f"{target} exists: choose another path, nothing is overwritten.")
        async with self.connect(call) as client:
            await client.download(job_id, wanted.path, target, **wanted.params, revision="latest")
        return text_of({"path": str(target.absolute()), "bytes": target.stat().st_size})


@dataclass(frozen=True, slots=True)
class RemoteFileTools:
    """Tools of an agent that shares no files with the service."""

    connect: Connect

    async def segment(
        self,
        call: Call,
        file_name: Annotated[
            str, Field(max_length=60, description="Its ending is the format: off, stl, ply, obj, glb, gltf or 3mf.")
        ],
        mesh_base64: Annotated[str | None, Field(description="The bytes of the file in base64, at most 8 MiB.")] = None,
        mesh_text: Annotated[str | None, Field(description="In place of it, the text of an OBJ or OFF file.")] = None,
    ) -> str:
        """Cut a 3D mesh into the parts that a person would name. Returns the job, whose id all other tools need.

        Larger files, and those with textures in other files, are sent by a program to POST /v1/jobs of this server
        with the same API key; list_jobs has their id then. Waits up to 45 seconds; then call job_status with wait_s.
        """
        mesh = _bytes_of(mesh_base64, mesh_text)
        with tempfile.TemporaryDirectory(prefix="cleave-") as folder:
            path = Path(folder) / _name_of(file_name)
            try:
                await asyncio.to_thread(path.write_bytes, mesh)
            except OSError:
                raise ToolError("The server cannot store the mesh at present: try again later.") from None
            async with self.connect(call) as client:
                job = await client.submit(path)
                return await job_text(client, job.id, LONGEST_WAIT_S)

    async def download(
        self,
        call: Call,
        job_id: JobId,
        result: Result,
        embed: Annotated[bool, Field(description="Return the bytes as a resource too, up to 1 MiB.")] = False,
    ) -> list[TextContent | EmbeddedResource]:
        """Return the path on this server from which a program gets the parts, with their names, with the same API key.

        The labels of every face (seg) are text of a line per face; a model has no use for them, a program has.
        """
        wanted = _result(result)
        async with self.connect(call) as client:
            job = await client.job(job_id)
            query = "&".join(f"{name}={value}" for name, value in {**wanted.params, "revision": "latest"}.items())
            uri = f"{job.document['links']['self']}/{wanted.path}?{query}"
            answer: list[TextContent | EmbeddedResource] = [TextContent(type="text", text=text_of({"path": uri}))]
            if embed:
                content = await client.content(job_id, wanted.path, **wanted.params, revision="latest")
                if len(content) > _MOST_RETURNED_BYTES:
                    raise ToolError(f"The result has {len(content)} bytes, too many for a message: get {uri} instead.")
                blob = BlobResourceContents(uri=f"cleave:{uri}", blob=base64.b64encode(content).decode())
                answer.append(EmbeddedResource(type="resource", resource=blob))
        return answer


def _bytes_of(mesh_base64: str | None, mesh_text: str | None) -> bytes:
    if (mesh_base64 is None) == (mesh_text is None):
        raise ToolError("Give the mesh either as mesh_base64 or as mesh_text.")
    try:
        mesh = base64.b64decode(mesh_base64, validate=True) if mesh_base64 is not None else (mesh_text or "").encode()
    except binascii.Error:
        raise ToolError(
            "mesh_base64 is not base64: send the bytes of the file in base64, without line breaks."
        ) from None
    if len(mesh) > MOST_SENT_BYTES:
        raise ToolError(f"The mesh has {len(mesh)} bytes, more than 8 MiB: let a program send it to POST /v1/jobs.")
    return mesh


def _name_of(file_name: str) -> str:
    """Return a name in a folder, whatever path an agent gives."""
    name = PurePath(file_name.replace("\0", "")).name
    return "mesh" if name in ("", "..") else name


def _result(name: str) -> ServerResult:
    if name not in _MODELS:
        raise ToolError(f"There is no result {name!r}: choose one of {', '.join(_MODELS)}.")
    return RESULTS[name]
