"""What all tools share: the client of a call, answers as short JSON, and errors for the model."""

import functools
import json
from collections.abc import Awaitable, Callable, Mapping
from contextlib import AbstractAsyncContextManager
from typing import Annotated, Any, ParamSpec, TypeAlias, TypeVar

from mcp.server.mcpserver import Context
from mcp.server.mcpserver.exceptions import ToolError
from pydantic import Field

from cleave.client import AsyncClient, ClientError, Edited
from segcore.errors import CleaveError

Call: TypeAlias = Context[Any, Any]
Connect: TypeAlias = Callable[[Call], AbstractAsyncContextManager[AsyncClient]]  # the client for the caller of a tool
JobId: TypeAlias = Annotated[str, Field(description="The id of the job, from segment or list_jobs.")]

P = ParamSpec("P")
Answer = TypeVar("Answer")
_DIGITS = 4  # of measurements


def told(tool: Callable[P, Awaitable[Answer]]) -> Callable[P, Awaitable[Answer]]:
    """Return a tool whose expected errors are sentences for the model."""

    @functools.wraps(tool)
    async def run(*args: P.args, **kwargs: P.kwargs) -> Answer:
        try:
            return await tool(*args, **kwargs)
        except (ClientError, CleaveError) as error:
            raise ToolError(str(error)) from error
        except OSError as error:
            raise ToolError(f"{error.filename}: {error.strerror}." if error.filename else str(error)) from error

    return run


def text_of(document: Mapping[str, Any]) -> str:
    """Return a document as JSON without white space, which costs a model the fewest tokens."""
    return json.dumps(_short(document), ensure_ascii=False, separators=(",", ":"))


def edited_text(edited: Edited) -> str:
    """Return what an edit has made."""
    revision = edited.revision
    assert revision is not None, "no preview"
    return text_of(
        {
            "revision": revision.number,
            "what": revision.what,
            "parts": [
                {"number": number, "name": part.name, "faces": part.faces} for number, part in enumerate(edited.parts)
            ],
            "next": "Numbers may have changed: look again before the next click or edit.",
        }
    )


def _short(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.{_DIGITS}g}")
    if isinstance(value, Mapping):
        return {name: _short(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [_short(one) for one in value]
    return value
