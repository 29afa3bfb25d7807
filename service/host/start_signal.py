"""A signal from the HTTP server that it has started, until which the other processes leave the processors to it."""

import os
import select
import time

_LONGEST_WAIT_S = 5.0  # the others start then in any case; set by hand


class StartSignal:
    """A pipe, to whose ``descriptor`` a child process writes when it has started."""

    def __init__(self) -> None:
        self._source, self.descriptor = os.pipe()
        self._latest = time.monotonic() + _LONGEST_WAIT_S
        self._has_come = False

    def has_come(self) -> bool:
        """Whether the child process has started, or has had its time."""
        if not self._has_come:
            readable, _, _ = select.select([self._source], [], [], 0)
            self._has_come = bool(readable) or time.monotonic() > self._latest
        return self._has_come
