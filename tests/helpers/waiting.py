"""Waiting for a condition."""

import time
from collections.abc import Callable


def wait_until(condition: Callable[[], object], within_s: float = 60.0) -> None:
    """Wait until a condition is true; fail if that takes too long, which is generous for busy machines."""
    gives_up_at = time.monotonic() + within_s
    while not condition():
        assert time.monotonic() < gives_up_at, "the condition did not come true in time"
        time.sleep(0.05)
