"""Requests that are repeated until the service answers them."""

import time
from collections.abc import Callable, Container
from contextlib import suppress

import httpx

from bench.errors import BenchmarkError

_PAUSE_S = 0.2
_GIVE_UP_S = 120.0  # longer than any fault of a benchmark makes the service unavailable


def until_answered(send: Callable[[], httpx.Response], expected: Container[int]) -> httpx.Response:
    """Send a request until the response has an expected status code.

    Raises
    ------
    BenchmarkError
        If the service refuses the request, or does not respond for two minutes.
    """
    deadline = time.monotonic() + _GIVE_UP_S
    while time.monotonic() < deadline:
        with suppress(httpx.TransportError):
            response = send()
            if response.status_code in expected:
                return response
            if response.status_code < 500:
                raise BenchmarkError(f"The service refuses a request: {response.text}")
        time.sleep(_PAUSE_S)
    raise BenchmarkError(f"The service does not respond within {_GIVE_UP_S:.0f} s: see its log.")
