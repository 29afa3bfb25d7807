"""The path below which a reverse proxy shows the service, such as /cleave."""

import re
from contextvars import ContextVar

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

_PREFIX = re.compile(r"(?:/[A-Za-z0-9._~-]+)+")
_prefix: ContextVar[str] = ContextVar("prefix", default="")


def public_path(path: str) -> str:
    """Return the path at which the client of the current request finds a path of the service."""
    return _prefix.get() + path


class MountMiddleware:
    """Reads the prefix from the header X-Forwarded-Prefix of the proxy, else from the settings.

    The proxy may remove the prefix from the path or leave it there. The prefix changes nothing but the links in the
    response to the same client, so that the header needs no trust; one that is no plain path is ignored.
    """

    def __init__(self, app: ASGIApp, root_path: str) -> None:
        """``root_path`` is the prefix of requests without the header; empty for none."""
        self._app = app
        self._root_path = root_path

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            prefix = self._prefix_of(Headers(scope=scope))
            path: str = scope["path"]
            if path == prefix:
                path = f"{prefix}/"
            elif not path.startswith(f"{prefix}/"):
                path = prefix + path
            scope = {**scope, "root_path": prefix, "path": path}
            _prefix.set(prefix)
        await self._app(scope, receive, send)

    def _prefix_of(self, headers: Headers) -> str:
        given = headers.get("x-forwarded-prefix", "").partition(",")[0].strip().rstrip("/")
        return given if _PREFIX.fullmatch(given) and ".." not in given.split("/") else self._root_path
