"""Clients of the application itself, for the tools of remote agents."""

from collections.abc import Mapping

import httpx
from fastapi import FastAPI

from cleave.client import AsyncClient
from service.mcp.calls import Call, Connect

_HOST = "http://127.0.0.1"
# Of the message of the agent: its API key, and the path that the proxy shows.
_PASSED_ON = ("authorization", "x-forwarded-prefix")


class _OwnTransport(httpx.ASGITransport):
    """Sends requests to an application of this process, with some headers."""

    def __init__(self, app: FastAPI, headers: Mapping[str, str]) -> None:
        super().__init__(app, raise_app_exceptions=False)
        self._headers = headers

    async def handle_async_request(self, request: httpx.Request) -> httpx.Response:
        request.headers.update(self._headers)
        return await super().handle_async_request(request)


def own_clients(app: FastAPI) -> Connect:
    """Return what makes a client of an application for the caller of a tool."""

    def connect(call: Call) -> AsyncClient:
        given = call.headers or {}
        passed_on = {name: given[name] for name in _PASSED_ON if name in given}
        return AsyncClient(_HOST, transport=_OwnTransport(app, passed_on))

    return connect
