"""/mcp of the service: the tools over streamable HTTP, behind the API keys."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

from fastapi import FastAPI, Request
from starlette.types import Receive, Scope, Send

from cleave.version import extra_command
from service.context import Context
from service.guard.callers import authorize
from service.problems import Problem

if TYPE_CHECKING:
    from mcp.server.streamable_http_manager import StreamableHTTPSessionManager

_MOST_BYTES = 12 * 2**20  # of a message: a mesh of file_tools.MOST_SENT_BYTES in base64, and the rest


class AgentEndpoint:
    """An ASGI application. Each message is complete in itself, so that any process of the service can answer it."""

    def __init__(self, app: FastAPI) -> None:
        self._app = app
        self._manager: StreamableHTTPSessionManager | None = None
        self._starting = asyncio.Lock()
        self._stop = asyncio.Event()
        self._task: asyncio.Task[None] | None = None

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        request = Request(scope)
        context: Context = self._app.state.context
        authorize(context, request.headers.get("authorization"))
        length = request.headers.get("content-length", "")
        if length.isdecimal() and int(length) > _MOST_BYTES:
            raise Problem(
                "too_large", f"A message to /mcp has at most {_MOST_BYTES} bytes: send large meshes to POST /v1/jobs."
            )
        manager = await self._started()
        await manager.handle_request(scope, receive, send)

    @asynccontextmanager
    async def serving(self) -> AsyncIterator[None]:
        """End what the first message has started, with the application."""
        try:
            yield
        finally:
            self._stop.set()
            if self._task is not None:
                await self._task

    async def _started(self) -> "StreamableHTTPSessionManager":
        """Return what handles messages; the first one imports the optional dependency, which takes a second."""
        async with self._starting:
            if self._manager is None:
                manager = await asyncio.to_thread(self._make)
                running = asyncio.Event()
                self._task = asyncio.create_task(self._run(manager, running))
                await running.wait()
                self._manager = manager
            return self._manager

    async def _run(self, manager: "StreamableHTTPSessionManager", running: asyncio.Event) -> None:
        async with manager.run():
            running.set()
            await self._stop.wait()

    def _make(self) -> "StreamableHTTPSessionManager":
        try:
            from mcp.server.transport_security import TransportSecuritySettings
        except ModuleNotFoundError as error:
            sentence = f"This server has no tools for agents: the operator adds them by {extra_command('mcp')}."
            raise Problem("not_found", sentence) from error
        from service.mcp.own_client import own_clients
        from service.mcp.server import mcp_server

        server = mcp_server(own_clients(self._app), has_files=False)
        server.streamable_http_app(
            stateless_http=True,
            json_response=True,
            max_request_body_size=_MOST_BYTES,
            # Host names and origins are checked by service.guard.
            transport_security=TransportSecuritySettings(enable_dns_rebinding_protection=False),
        )
        return server.session_manager
