"""Refusal of query parameters that a route does not have, so that a misspelt one is never ignored."""

import difflib
from collections.abc import Iterable, Iterator

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
    route = request.scope["route"]
    assert isinstance(route, APIRoute)
    known = set(_query_parameters(route.dependant))
    for name in request.query_params:
        if name not in known:
            raise Problem("invalid_request", unknown_name("query parameter", name, known))


def _query_parameters(dependant: Dependant) -> Iterator[str]:
    yield from (field.alias for field in dependant.query_params)
    for needed in dependant.dependencies:
        yield from _query_parameters(needed)


def unknown_name(what: str, name: str, known: Iterable[str]) -> str:
    """Return a sentence for a name that is not known: the nearest known one, or all of them."""
    names = sorted(set(known))
    shown = f"There is no {what} {name[:80]!r} here"
    near = difflib.get_close_matches(name, names, 1)
    if name in _ELSEWHERE:
        return f"{shown}: {_ELSEWHERE[name]}."
    if near:
        return f"{shown}: the nearest one is {near[0]!r}."
    return f"{shown}; there are {', '.join(names)}." if names else f"{shown}, and no other."
