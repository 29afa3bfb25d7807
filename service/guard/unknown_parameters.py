"""Refusal of query parameters that a route does not have, so that a misspelt one is never ignored."""

import difflib
from collections.abc import Iterator

from fastapi import Request
from fastapi.dependencies.models import Dependant
from fastapi.routing import APIRoute

from service.problems import Problem

_KEY_IN_HEADER = "send an API key in the header Authorization: Bearer KEY"
# What clients look for in the query although it is elsewhere.
_ELSEWHERE = {
    "wait": "to wait for the result, send the header Prefer: wait=SECONDS",
    "max_segments": 'it is one of the parameters, such as ?parameters={"max_segments": 32}',
} | dict.fromkeys(("api_key", "key", "token"), _KEY_IN_HEADER)


async def refuse_unknown_parameters(request: Request) -> None:
    """A dependency of all routes of the API.

    Raises
    ------
    Problem
        If the query has a parameter that the route does not have; the message names the nearest one.
    """
    if not request.query_params:
        return
    route = request.scope["route"]
    assert isinstance(route, APIRoute)
    known = set(_query_parameters(route.dependant))
    for name in request.query_params:
        if name not in known:
            raise Problem("invalid_request", _sentence(name, sorted(known)))


def _query_parameters(dependant: Dependant) -> Iterator[str]:
    yield from (field.alias for field in dependant.query_params)
    for needed in dependant.dependencies:
        yield from _query_parameters(needed)


def _sentence(name: str, known: list[str]) -> str:
    """Return a sentence for a name that is not known: the nearest known one, or all of them."""
    shown = f"There is no query parameter {name[:80]!r} here"
    near = difflib.get_close_matches(name, known, 1)
    if name in _ELSEWHERE:
        return f"{shown}: {_ELSEWHERE[name]}."
    if near:
        return f"{shown}: the nearest one is {near[0]!r}."
    if len(known) == 1:
        return f"{shown}; the only one is {known[0]!r}."
    return f"{shown}; there are {', '.join(known)}." if known else f"{shown}, and no other."
