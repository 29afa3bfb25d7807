"""A webhook message: allowed targets, signature (Standard Webhooks 1.0), sending."""

import base64
import hmac
import ipaddress
import json
import socket
from datetime import datetime
from urllib.parse import urlsplit

from worker.jobs.job import Job, Outcome

_TIMEOUT_S = 10.0  # to connect, and between two parts of the answer; set by hand
SECRET_PREFIX = "whsec_"  # nosec B105  # of all secrets in Standard Webhooks


class Undeliverable(Exception):  # noqa: N818
    """The message could not be delivered, for the reason in the text."""


def objection_to(url: str, private_targets: bool) -> str | None:
    """Return what is wrong with the URL of a webhook, in a sentence; None if nothing can be seen before it is used."""
    try:
        parts = urlsplit(url)
        host, _ = parts.hostname, parts.port
    except ValueError:
        host, parts = None, urlsplit("")
    is_plain = url.isascii() and url.isprintable() and " " not in url and parts.username is None
    if parts.scheme not in ("http", "https") or not host or not is_plain:
        return "webhook must be a URL such as https://example.com/hook, without a name or password."
    if not private_targets and (host == "localhost" or not _may_be_public(host)):
        return "webhook must lead to a public address."
    return None


def webhook_body(job: Job, outcome: Outcome, root_path: str = "") -> bytes:
    """Return the body of the message, which has the id and the status; receivers fetch the rest from the API.

    Parameters
    ----------
    root_path : the path below which a proxy shows the service.
    """
    message = {
        "type": f"job.{outcome.status}",
        "timestamp": outcome.finished_at.isoformat().replace("+00:00", "Z"),
        "data": {"id": job.id, "status": outcome.status, "links": {"self": f"{root_path}/v1/jobs/{job.id}"}},
    }
    return json.dumps(message, separators=(",", ":")).encode()


def signature(secret: bytes, message_id: str, timestamp: int, body: bytes) -> str:
    signed = f"{message_id}.{timestamp}.".encode() + body
    return "v1," + base64.b64encode(hmac.digest(secret, signed, "sha256")).decode()


def shown_secret(secret: bytes) -> str:
    """Return a secret in the form in which receivers get it."""
    return SECRET_PREFIX + base64.b64encode(secret).decode()


def send(url: str, message_id: str, secret: bytes, body: bytes, at: datetime, private_targets: bool) -> None:
    """Post a message once.

    The host name is resolved once, and the request goes to the address that was checked, so that a second resolution
    cannot lead elsewhere. Redirects are not followed.

    Raises
    ------
    Undeliverable
        If the address is not allowed, or the response is not a success.
    """
    parts = urlsplit(url)
    address = _public_address(str(parts.hostname), parts.port or {"https": 443}.get(parts.scheme, 80), private_targets)
    timestamp = int(at.timestamp())
    headers = {
        "Host": parts.netloc,
        "Content-Type": "application/json",
        "User-Agent": "Cleave",
        "webhook-id": message_id,
        "webhook-timestamp": str(timestamp),
        "webhook-signature": signature(secret, message_id, timestamp, body),
    }
    import httpx  # the service checks targets without it

    target = httpx.URL(url).copy_with(host=address)
    try:
        with (
            httpx.Client(timeout=_TIMEOUT_S, trust_env=False) as client,
            client.stream(
                "POST", target, content=body, headers=headers, extensions={"sni_hostname": str(parts.hostname)}
            ) as response,
        ):
            if not response.is_success:
                raise Undeliverable(f"the response was {response.status_code}")
    except httpx.HTTPError as error:
        raise Undeliverable(type(error).__name__) from error


def _public_address(host: str, port: int, private_targets: bool) -> str:
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError) as error:
        raise Undeliverable("the host name cannot be resolved") from error
    addresses = [str(entry[4][0]) for entry in found]
    for address in addresses:
        if not private_targets and not _may_be_public(address.partition("%")[0]):
            raise Undeliverable("the host name resolves to an address that is not public")
    return addresses[0]


def _may_be_public(host: str) -> bool:
    """Whether a host can be public: False for addresses that are not global, True for names."""
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return True
    return address.is_global and not address.is_multicast
