"""Waits for a job's child process, the work-horse, and kills it on timeout, cancel or shutdown."""

import os
import select
import signal
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Literal, TypeAlias

from cleave.settings import Settings

StopReason: TypeAlias = Literal["ended elsewhere", "timed_out", "shutdown"]

_TICK_S = 1.0  # between two checks: a timeout takes effect within this time, and a cancel within two
_PIPE_BYTES = 65536  # the size of a pipe in Linux, so that a read returns all reports that wait


class Watch:
    """Waits for the work-horses of a worker; a signal handler can set the time at which the current one is killed."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._stop_by = float("inf")  # on the monotonic clock
        self._had_ended = False  # whether the job had ended at the tick before

    def stop_within(self, grace_s: float) -> None:
        """Kill the current work-horse if it still runs after a time."""
        self._stop_by = time.monotonic() + grace_s

    def pause(self, seconds: float) -> None:
        """Sleep for a time, or until the time set by stop_within."""
        time.sleep(max(0.0, min(seconds, self._stop_by - time.monotonic())))

    def wait(
        self,
        work_horse: int,
        pipe: int,
        has_ended: Callable[[], bool],
        on_tick: Callable[[], None],
        on_reports: Callable[[bytes], None] = lambda _: None,
    ) -> StopReason | None:
        """Wait until a work-horse has ended; return why it was killed, None if it ended by itself.

        Parameters
        ----------
        work_horse : its process id.
        pipe : the end to read of the pipe that it writes reports to, and holds open until it ends; it is closed.
        has_ended : returns whether its job has an outcome or no longer exists.
        on_tick : called about once a second.
        on_reports : called with reports as they are written.
        """
        overruns_at = time.monotonic() + self._settings.job_timeout_s
        stopped_for: StopReason | None = None
        self._had_ended = False
        while not self._has_exited(pipe, on_reports):
            on_tick()
            stopped_for = stopped_for or self._reason_to_stop(has_ended, overruns_at)
            if stopped_for:
                os.kill(work_horse, signal.SIGKILL)  # compiled code does not react to other signals
        os.close(pipe)
        return stopped_for

    def _has_exited(self, pipe: int, on_reports: Callable[[bytes], None]) -> bool:
        """Pass reports on for the time of a tick; return whether the pipe has ended, before that time is over."""
        tick_at = time.monotonic() + _TICK_S
        while (left_s := tick_at - time.monotonic()) > 0:
            if select.select([pipe], [], [], left_s)[0]:
                reports = os.read(pipe, _PIPE_BYTES)
                if not reports:
                    return True
                on_reports(reports)
        return False

    def _reason_to_stop(self, has_ended: Callable[[], bool], overruns_at: float) -> StopReason | None:
        with suppress(OSError):  # the store may answer again before the job ends
            # One tick later: a work-horse that has just given the job its outcome still has to count and to log it.
            had_ended, self._had_ended = self._had_ended, has_ended()
            if had_ended and self._had_ended:
                return "ended elsewhere"
        if time.monotonic() > overruns_at:
            return "timed_out"
        return "shutdown" if time.monotonic() > self._stop_by else None
