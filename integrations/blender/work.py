"""Work beside Blender's user interface: with a time limit, a way to stop it, and its state in words."""

import threading
import time
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

from .errors import CanceledError, CleaveError


class Watch:
    """What a piece of work asks and tells while it runs."""

    def __init__(self, limit_s: float) -> None:
        self.limit_s = limit_s
        self.state = ""
        self._end = time.monotonic() + limit_s
        self._stop = threading.Event()

    def stop(self) -> None:
        self._stop.set()

    def check(self) -> float:
        """Return the seconds that are left.

        Raises
        ------
        CanceledError
            If the work was stopped.
        CleaveError
            If no time is left.
        """
        if self._stop.is_set():
            raise CanceledError("Canceled.")
        left = self._end - time.monotonic()
        if left <= 0:
            raise CleaveError(
                f"Not finished after {self.limit_s:g} s: raise the time limit in the preferences of the extension, "
                "or use a smaller mesh."
            )
        return left

    def pause(self, seconds: float) -> None:
        """Wait for so long, less if the work is stopped or its time is over; errors as of :meth:`check`."""
        self._stop.wait(min(seconds, self.check()))
        self.check()


Solve: TypeAlias = Callable[[Watch], Any]


class Work(threading.Thread):
    """Carries out several tasks, one after the other; ``results`` and ``error`` are complete when it has ended."""

    def __init__(self, tasks: Mapping[str, Solve], limit_s: float) -> None:
        super().__init__(daemon=True)
        self.tasks = tasks
        self.watch = Watch(limit_s)
        self.results: dict[str, Any] = {}
        self.error: CleaveError | None = None

    def run(self) -> None:
        try:
            for key, solve in self.tasks.items():
                self.watch.check()
                self.results[key] = solve(self.watch)
        except CleaveError as error:
            self.error = error
        except Exception as error:  # of any kind: people see a sentence, not a traceback
            self.error = CleaveError(f"Unexpected error in the extension: {type(error).__name__}: {error}")
