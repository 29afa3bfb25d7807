"""Commands for curl, made from the operations of the OpenAPI document."""

import json
import shlex
from typing import Any

from service.openapi.examples import example_of
from service.openapi.schema_tables import Schema

SERVER = "http://127.0.0.1:8000"
EXAMPLE_ID = "5f1c5d1d2c0f4e0fa8f0b4b2f1a9d6c3"  # of a job, a batch or an edit
_KEY = '-H "Authorization: Bearer $API_KEY"'
_TEXTS = ("text/plain", "text/event-stream")


def command(method: str, path: str, operation: dict[str, Any], schemas: dict[str, Schema]) -> str:
    """Return the command that sends a request with the body that the operation needs, and saves files that are no text.

    Parameters
    ----------
    schemas : those of the document, by name.
    """
    words = ["curl"]
    if method not in ("get", "post"):
        words += ["-X", method.upper()]
    words.append(shlex.quote(SERVER + path.replace("{revision}", "latest").format_map(_Ids())))
    if operation.get("security"):
        words.append(_KEY)
    words += _body(method, operation.get("requestBody", {}).get("content", {}), schemas)
    words += _target(path, operation["responses"])
    return " ".join(words)


class _Ids(dict[str, str]):
    """The values of the parameters of a path."""

    def __missing__(self, name: str) -> str:
        return EXAMPLE_ID


def _body(method: str, content: dict[str, Any], schemas: dict[str, Schema]) -> list[str]:
    if "multipart/form-data" in content:
        return ["-F", "mesh=@hand.off"]
    if "application/json" in content:
        body = json.dumps(example_of(content["application/json"]["schema"], schemas))
        return ["-H", "'Content-Type: application/json'", "-d", shlex.quote(body)]
    return ["-d", "''"] if method == "post" else []


def _target(path: str, responses: dict[str, Any]) -> list[str]:
    """Return the option that saves the response under its last name if it is no text."""
    media_types = list(responses.get("200", {}).get("content", ()))
    is_text = any(one.endswith("json") or one in _TEXTS for one in media_types)
    return [] if is_text or not media_types else ["-o", path.rpartition("/")[2]]
