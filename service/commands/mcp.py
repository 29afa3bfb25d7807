"""`cleave mcp`: tools for an agent on this machine, over standard input and output."""

import argparse
import asyncio
import os
import signal
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from cleave.client import AsyncClient
from cleave.settings import InvalidSettings
from cleave.version import extra_command
from service.mcp.standalone import CannotServe, own_service


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Give an agent tools to segment meshes, to see their parts, and to name and edit them: an MCP server on "
        "standard input and output. Without --server it runs a service of its own, whose jobs are deleted at its end "
        "unless --data-dir names a folder. If the server requires an API key, set it in the environment variable "
        "CLEAVE_API_KEY."
    )
    parser.add_argument("--server", metavar="URL", help="a service that runs already")
    parser.add_argument("--data-dir", type=Path, metavar="DIR", help="keep the jobs of its own service in this folder")


def run(choices: argparse.Namespace) -> None:
    """Serve one agent until it closes standard input.

    Raises
    ------
    InvalidSettings
        If the optional dependency for it is not installed, or its own service does not start.
    """
    try:
        from service.mcp.server import mcp_server
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("mcp", "mcp_types"):
            raise
        raise InvalidSettings(f"Tools for agents need an optional dependency: {extra_command('mcp')}.") from error
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    with ExitStack() as stack:
        try:
            url = choices.server or stack.enter_context(own_service(choices.data_dir))
        except CannotServe as error:
            raise InvalidSettings(str(error)) from error
        _end_on_signals(stack)
        api_key = os.environ.get("CLEAVE_API_KEY") if choices.server else None

        def connect(_: Any) -> AsyncClient:
            return AsyncClient(url, api_key)

        asyncio.run(mcp_server(connect, has_files=True).run_stdio_async())


def _end_on_signals(stack: ExitStack) -> None:
    """Stop the service of its own and end the process on a signal, although a thread waits for standard input."""
    from service.commands.main import INTERRUPTED

    def end(number: int, _: object) -> None:
        stack.close()
        os._exit(INTERRUPTED if number == signal.SIGINT else 0)

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, end)
