"""Opens a bucket from the URL of the store: its address, credentials, timeouts and retries."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import timedelta
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qsl, urlsplit

import obstore
from obstore.exceptions import BaseError
from obstore.store import AzureStore, GCSStore, MemoryStore, S3Store

from cleave.settings import InvalidSettings

if TYPE_CHECKING:
    from obstore.store import ClientConfig, ObjectStore, RetryConfig

_SCHEMES = ("s3", "gs", "az", "memory")
_OPTIONS = {"s3": ("endpoint", "public_endpoint", "region"), "az": ("endpoint", "public_endpoint")}

# The API reports within two seconds that the store does not answer. Within this time a read is tried twice. A write is
# tried once, as a write without an answer may have been done. A connection that is refused is tried again.
_READ_S, _WRITE_S, _CONNECT_S = 0.8, 1.6, 0.7
_RETRIES_S, _FIRST_PAUSE = 1.0, timedelta(milliseconds=50)
# A transfer takes as long as its file is large, but it fails if no byte arrives for some seconds. Set by hand.
_TRANSFER_S, _SILENCE_S, _TRANSFER_RETRIES_S = 3600.0, 10.0, 30.0


@dataclass(frozen=True, slots=True)
class Bucket:
    """A bucket, or the part of it under a prefix, through clients with different timeouts."""

    reads: "ObjectStore"  # of small objects
    writes: "ObjectStore"  # of small objects
    transfers: "ObjectStore"  # of files
    signer: S3Store | GCSStore | AzureStore | None  # of URLs for clients; None if the storage has none

    def sign(self, key: str, valid: timedelta) -> str | None:
        return None if self.signer is None else obstore.sign(self.signer, "GET", key, valid)


def open_bucket(url: str) -> Bucket:
    """Open the bucket of a URL such as ``s3://bucket/prefix?endpoint=https://host:9000``.

    Credentials come from the environment (``AWS_ACCESS_KEY_ID`` and the like) or from the role of the machine.

    Raises
    ------
    InvalidSettings
        If the URL is not that of a bucket.
    """
    parts = urlsplit(url)
    options = dict(parse_qsl(parts.query))
    if parts.scheme not in _SCHEMES or not (parts.netloc or parts.scheme == "memory"):
        raise InvalidSettings(
            "CLEAVE_STORE_URL must be s3://BUCKET/PREFIX, gs://BUCKET/PREFIX or az://CONTAINER/PREFIX."
        )
    known = _OPTIONS.get(parts.scheme, ())
    if not set(options) <= set(known):
        raise InvalidSettings(f"CLEAVE_STORE_URL: the options of {parts.scheme}:// are {', '.join(known) or 'none'}.")
    if parts.scheme == "memory":
        memory = MemoryStore()
        return Bucket(memory, memory, memory, None)
    public = options.pop("public_endpoint", None)

    def client(timeout_s: float, silence_s: float, retries_s: float, **changed: str) -> Any:
        given = options | changed
        timeouts: ClientConfig = {
            "connect_timeout": timedelta(seconds=_CONNECT_S),
            "timeout": timedelta(seconds=timeout_s),
            "read_timeout": timedelta(seconds=silence_s),
            "allow_http": given.get("endpoint", "").startswith("http://"),
        }
        retries: RetryConfig = {
            "max_retries": 1 if retries_s <= _RETRIES_S else 10,
            "retry_timeout": timedelta(seconds=retries_s),
            "backoff": {"init_backoff": _FIRST_PAUSE, "max_backoff": timedelta(seconds=2), "base": 2},
        }
        return _store(parts.scheme, parts.netloc, parts.path.strip("/"), given, timeouts, retries)

    try:
        reads = client(_READ_S, _READ_S, _RETRIES_S)
        return Bucket(
            reads=reads,
            writes=client(_WRITE_S, _WRITE_S, _RETRIES_S),
            transfers=client(_TRANSFER_S, _SILENCE_S, _TRANSFER_RETRIES_S),
            signer=client(_READ_S, _READ_S, _RETRIES_S, endpoint=public) if public else reads,
        )
    except BaseError as error:
        raise InvalidSettings(f"CLEAVE_STORE_URL cannot be used: {str(error).splitlines()[0]}.") from error


def _store(
    scheme: str, name: str, prefix: str, options: dict[str, str], timeouts: "ClientConfig", retries: "RetryConfig"
) -> "ObjectStore":
    common: dict[str, Any] = {"prefix": prefix or None, "client_options": timeouts, "retry_config": retries}
    stores: dict[str, Callable[..., ObjectStore]] = {"s3": S3Store, "gs": GCSStore, "az": AzureStore}
    return stores[scheme](name, config=options, **common)
