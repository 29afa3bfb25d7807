"""The caller of a request: the owner of its API key, if keys are required."""

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer

from service.context import Context, ContextOf
from service.problems import Problem

_BEARER = HTTPBearer(auto_error=False, scheme_name="ApiKey", description="An API key, if the installation has any.")


@dataclass(frozen=True, slots=True)
class Caller:
    """The owner of the jobs that a request reads and creates."""

    owner: str | None  # the name of the API key; None if no keys are required


def authorize(context: Context, authorization: str | None) -> Caller:
    """Return the caller of a request with an Authorization header.

    Raises
    ------
    Problem
        If a key is required, and the header has none or an unknown one.
    """
    if not context.keys_required:
        return Caller(None)
    scheme, _, key = (authorization or "").partition(" ")
    if scheme.lower() != "bearer" or not key:
        raise Problem("unauthorized", "Send an API key in the header Authorization: Bearer KEY.")
    owner = context.keys.owner_of(key)
    if owner is None:
        raise Problem("unauthorized", "This API key is unknown here: ask the operator for one.")
    return Caller(owner)


async def _caller(
    context: ContextOf, credentials: Annotated[HTTPAuthorizationCredentials | None, Depends(_BEARER)]
) -> Caller:
    given = None if credentials is None else f"Bearer {credentials.credentials}"
    return authorize(context, given)


CallerOf = Annotated[Caller, Depends(_caller)]
