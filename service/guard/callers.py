"""Who asks: the owner of the API key, where keys are required."""

import ipaddress
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer
from starlette.types import ASGIApp, Receive, Scope, Send

from service.context import ContextOf
from service.problems import Problem

_BEARER = HTTPBearer(auto_error=False, scheme_name="ApiKey", description="An API key, where the installation has any.")
_HARMLESS_METHODS = ("GET", "HEAD", "OPTIONS")
_FOREIGN_SITES = ("cross-site", "same-site")


@dataclass(frozen=True, slots=True)
class Caller:
    """Whose jobs a request sees and makes."""

    owner: str | None  # the name of the API key; None where none is required


async def _caller(
    context: ContextOf, credentials: Annotated[HTTPAuthorizationCredentials | None, Depends(_BEARER)]
) -> Caller:
    if not context.keys_required:
        return Caller(None)
    if credentials is None:
        raise Problem("unauthorized", "Send an API key in the header Authorization: Bearer KEY.")
    owner = context.keys.owner_of(credentials.credentials)
    if owner is None:
        raise Problem("unauthorized", "This API key is not known here: ask the operator for one.")
    return Caller(owner)


CallerOf = Annotated[Caller, Depends(_caller)]


class LocalNames:
    """Answers to no other names than those that only this machine can have: for a service without keys on loopback.

    Whoever owns a name can turn it to 127.0.0.1 while their page is open (DNS rebinding), upon which the browser takes
    the service for a part of their site. An address cannot be turned.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http" and not _is_local_name(Request(scope).headers.get("host", "")):
            problem = Problem(
                "foreign_site",
                "Without API keys only localhost and addresses are answered: make a key with `cleave key NAME`, or set "
                "CLEAVE_AUTH=off where something else keeps strangers out.",
            )
            await problem.response()(scope, receive, send)
            return
        await self._app(scope, receive, send)


def _is_local_name(host: str) -> bool:
    """Whether what a Host header says is nothing, an address, or a name that always leads to this machine."""
    name = host.rpartition(":")[0] if host.rpartition(":")[2].isdigit() else host
    name = name.lower().rstrip(".")
    if name in ("", "localhost") or name.endswith(".localhost"):
        return True
    try:
        ipaddress.ip_address(name.strip("[]"))
    except ValueError:
        return False
    return True


class ForeignSites:
    """Refuses what pages of other sites have a browser send without asking: forms need no CORS.

    Whoever visits such a page could otherwise be made to fill the disk of a service on their own machine.
    """

    def __init__(self, app: ASGIApp, allowed_origins: list[str]) -> None:
        self._app = app
        self._allowed_origins = allowed_origins

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http" and scope["method"] not in _HARMLESS_METHODS:
            headers = Request(scope).headers
            foreign = headers.get("sec-fetch-site") in _FOREIGN_SITES
            if foreign and not {"*", headers.get("origin")} & set(self._allowed_origins):
                problem = Problem(
                    "foreign_site",
                    "A page of another site sent this: the operator can allow it in CLEAVE_CORS_ORIGINS.",
                )
                await problem.response()(scope, receive, send)
                return
        await self._app(scope, receive, send)
