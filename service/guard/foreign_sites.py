"""Middleware that refuses requests which pages of other sites make a browser send."""

import ipaddress

from fastapi import Request
from starlette.types import ASGIApp, Receive, Scope, Send

from service.problems import Problem

_SAFE_METHODS = ("GET", "HEAD", "OPTIONS")  # RFC 9110, section 9.2.1
_FOREIGN_SITES = ("cross-site", "same-site")  # values of Sec-Fetch-Site; the others are same-origin and none


class HostCheckMiddleware:
    """Refuses requests for any host name but ``localhost``. It protects a service without keys on a loopback address.

    The owner of a name can let it resolve to 127.0.0.1 while their page is open (DNS rebinding): the browser then takes
    the service for a part of their site. Requests for an IP address cannot be redirected in this way and are accepted.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http" and not _is_local_name(Request(scope).headers.get("host", "")):
            problem = Problem(
                "foreign_site",
                "Without API keys only requests for localhost and IP addresses are accepted: make a key with "
                "`cleave key NAME`, or set CLEAVE_AUTH=off if access is restricted by other means.",
            )
            await problem.response()(scope, receive, send)
            return
        await self._app(scope, receive, send)


class CrossSiteCheckMiddleware:
    """Refuses unsafe requests from pages of other sites, unless their origin is allowed.

    A browser sends forms to other sites without asking by CORS, so any page could otherwise fill the disk of a service
    on the machine of its visitor.
    """

    def __init__(self, app: ASGIApp, allowed_origins: list[str]) -> None:
        self._app = app
        self._allowed_origins = allowed_origins

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http" and scope["method"] not in _SAFE_METHODS:
            headers = Request(scope).headers
            is_foreign = headers.get("sec-fetch-site") in _FOREIGN_SITES
            if is_foreign and not {"*", headers.get("origin")} & set(self._allowed_origins):
                problem = Problem(
                    "foreign_site",
                    "The request comes from a page of another site: the operator can allow it in CLEAVE_CORS_ORIGINS.",
                )
                await problem.response()(scope, receive, send)
                return
        await self._app(scope, receive, send)


def _is_local_name(host: str) -> bool:
    """Whether a Host header is empty, an IP address, or a name that always resolves to this machine (RFC 6761)."""
    name = host.rpartition(":")[0] if host.rpartition(":")[2].isdigit() else host
    name = name.lower().rstrip(".")
    if name in ("", "localhost") or name.endswith(".localhost"):
        return True
    try:
        ipaddress.ip_address(name.strip("[]"))
    except ValueError:
        return False
    return True
