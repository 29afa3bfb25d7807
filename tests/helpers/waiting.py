"""Waiting for a condition."""

import time
from collections.abc import Callable

# A condition that is false for long is looked at rarely, as many take time of the processors themselves.
_SHORTEST_PAUSE_S, _LONGEST_PAUSE_S = 0.05, 0.25


def wait_until(condition: Callable[[], object], within_s: float = 60.0) -> None:
    """Wait until a condition is true; fail if that takes too long, which is generous for busy machines."""
    began_at = time.monotonic()
    while not condition():
        waited_s = time.monotonic() - began_at
        assert waited_s < within_s, "the condition did not come true in time"
        time.sleep(min(max(0.1 * waited_s, _SHORTEST_PAUSE_S), _LONGEST_PAUSE_S))
