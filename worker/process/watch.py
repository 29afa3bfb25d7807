"""The eye on a work-horse: it is let run, and stopped for a reason."""

import os
import select
import signal
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Literal, TypeAlias

from cleave.settings import Settings

StopReason: TypeAlias = Literal["ended elsewhere", "timed_out", "shutdown"]

_TICK_S = 1.0  # how often a running job is looked at


class Watch:
    """Waits for the end of work-horses. A signal handler may say by when the one that runs has to be stopped."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._stop_by = float("inf")  # on the monotonic clock

    def stop_within(self, grace_s: float) -> None:
        self._stop_by = time.monotonic() + grace_s

    def pause(self, seconds: float) -> None:
        """Do nothing for a time, or until a stop is due."""
        time.sleep(max(0.0, min(seconds, self._stop_by - time.monotonic())))

    def wait(
        self, work_horse: int, gone: int, has_ended: Callable[[], bool], on_tick: Callable[[], None]
    ) -> StopReason | None:
        """Wait until a work-horse is gone; why it had to be stopped, None where it ended by itself.

        Parameters
        ----------
        work_horse : its process id.
        gone : a descriptor that becomes readable with its end; it is closed.
        has_ended : whether its job has an outcome, or is no longer there.
        on_tick : called about once a second.
        """
        overruns_at = time.monotonic() + self._settings.job_timeout_s
        stopped_for: StopReason | None = None
        while not select.select([gone], [], [], _TICK_S)[0]:
            on_tick()
            stopped_for = stopped_for or self._reason_to_stop(has_ended, overruns_at)
            if stopped_for:
                os.kill(work_horse, signal.SIGKILL)  # nothing less ends one that is busy in compiled code
        os.close(gone)
        return stopped_for

    def _reason_to_stop(self, has_ended: Callable[[], bool], overruns_at: float) -> StopReason | None:
        with suppress(OSError):  # a store that does not answer now may do so when the work is done
            if has_ended():
                return "ended elsewhere"
        if time.monotonic() > overruns_at:
            return "timed_out"
        return "shutdown" if time.monotonic() > self._stop_by else None
