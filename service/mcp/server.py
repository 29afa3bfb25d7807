"""The MCP server: its tools and what it says about itself."""

from collections.abc import Awaitable, Callable
from typing import Any

from mcp.server.mcpserver import MCPServer
from mcp_types import ToolAnnotations

from cleave.version import installed_version
from service.mcp.calls import Connect, told
from service.mcp.file_tools import LocalFileTools, RemoteFileTools
from service.mcp.job_tools import JobTools
from service.mcp.picture_tools import PictureTools

_INSTRUCTIONS = """\
Cleave cuts a 3D mesh into the parts that a person would name. It does not know their names: you see the picture and \
name them. A usual order: segment; look from corner, back and bottom until no part is hidden; if parts are too many or \
too few, set_level; correct single parts with merge_parts, split_part and find_part; name_parts for all parts in one \
call; look again to check; download. Parts have the numbers 0, 1, ..., which may change by an edit. Every edit makes a \
revision, and restore_revision undoes it."""


def mcp_server(connect: Connect, *, has_files: bool) -> MCPServer:
    """Return a server with all tools.

    Parameters
    ----------
    connect : returns the client of the HTTP API for the caller of a tool.
    has_files : whether callers name files of this machine; otherwise meshes are in their messages.
    """
    server: MCPServer = MCPServer(
        "cleave",
        title="Cleave",
        instructions=_INSTRUCTIONS,
        version=installed_version(),
        subscriptions=False,
        log_level="WARNING",
    )
    jobs, pictures = JobTools(connect), PictureTools(connect)
    files = LocalFileTools(connect) if has_files else RemoteFileTools(connect)
    reading: list[Callable[..., Awaitable[Any]]] = [
        jobs.list_jobs,
        jobs.job_status,
        jobs.list_parts,
        pictures.look,
        pictures.part_at,
    ]
    making: list[Callable[..., Awaitable[Any]]] = [
        files.segment,
        jobs.set_level,
        jobs.merge_parts,
        pictures.split_part,
        pictures.find_part,
        jobs.name_parts,
        jobs.restore_revision,
        files.download,
    ]
    for tool in reading + making:
        hints = ToolAnnotations(read_only_hint=tool in reading, destructive_hint=False, open_world_hint=False)
        server.add_tool(told(tool), annotations=hints, structured_output=False)
    return server
