"""Waiting for a condition."""

import time
from collections.abc import Callable


def wait_until(condition: Callable[[], object], within_s: float = 60.0) -> None:
    """Wait for a condition; a busy machine may take long, a test may not wait for ever."""
    gives_up_at = time.monotonic() + within_s
    while not condition():
        assert time.monotonic() < gives_up_at, "the condition did not come true in time"
        time.sleep(0.05)
