"""Requests to a Cleave server with the standard library."""

import http.client
import json
import urllib.error
import urllib.parse
import urllib.request
from email.message import Message
from typing import Any

from .errors import CleaveError

_LOOPBACK = ("localhost", "127.0.0.1", "::1")


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    """Redirects are errors: urllib would send the API key to wherever they lead."""

    def redirect_request(self, *_: Any) -> None:
        return None


_OPENER = urllib.request.build_opener(_NoRedirect)


class RefusedError(CleaveError):
    """The server has answered with an error."""

    def __init__(self, status: int, message: str, retry_after_s: float | None) -> None:
        super().__init__(message)
        self.status = status
        self.retry_after_s = retry_after_s  # None if the request need not be sent again


def server_url(text: str) -> str:
    """The URL of a server without a slash at its end.

    Raises
    ------
    CleaveError
        If it is not one.
    """
    url = text.strip().rstrip("/")
    try:
        parts = urllib.parse.urlsplit(url)
        is_url = parts.scheme in ("http", "https") and bool(parts.hostname) and (parts.port or True)
    except ValueError:
        is_url = False
    if not is_url:
        raise CleaveError(f"{text!r} is no URL of a server: enter one such as http://127.0.0.1:8000.")
    return url


def is_loopback(url: str) -> bool:
    """Whether a server is on this machine, so that no network is needed."""
    return urllib.parse.urlsplit(url).hostname in _LOOPBACK


def send(request: urllib.request.Request, timeout_s: float) -> bytes:
    """Return the body of the response.

    Raises
    ------
    RefusedError
        If the server answers with an error or a redirect.
    CleaveError
        If there is no response.
    """
    try:
        with _OPENER.open(request, timeout=timeout_s) as response:
            body: bytes = response.read()
            return body
    except urllib.error.HTTPError as error:
        with error:
            raise _refusal(error.code, error.headers, _read(error)) from error
    except (OSError, http.client.HTTPException, ValueError) as error:
        reason = getattr(error, "reason", None) or error
        raise CleaveError(
            f"No answer from {request.host} ({reason}): is the server running, and its URL right?"
        ) from error


def _read(error: urllib.error.HTTPError) -> bytes:
    try:
        return error.read()
    except (OSError, http.client.HTTPException):
        return b""


def _refusal(status: int, headers: Message, body: bytes) -> RefusedError:
    if 300 <= status < 400:
        return RefusedError(
            status, f"The server is elsewhere: enter the URL {headers.get('Location', '')} in its place.", None
        )
    try:
        message = str(json.loads(body)["detail"])
    except (ValueError, KeyError, TypeError):
        message = f"The server answers with status {status}: is the URL that of a Cleave server?"
    if status == 401:
        message += " Enter the key in the preferences of the extension."
    retried = status in (429, 502, 503, 504)
    seconds = headers.get("Retry-After", "")
    return RefusedError(status, message, (float(seconds) if seconds.isdigit() else 1.0) if retried else None)
