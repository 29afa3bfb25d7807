"""The kernels of a worker: those that every job needs are compiled before its first job, the others beside its jobs."""

import logging
import os
import subprocess
import sys
import time
from functools import partial

from redis import Redis

import segcore
from cleave.parent_death import die_with_parent
from segcore.io.reading import load_readers
from segcore.kernels import FIRST, CompilationProgress, compile_kernels, environment, must_compile
from worker.jobs.queue.compilation import Compilation, publish_compilation
from worker.jobs.queue.connection import QueueError

log = logging.getLogger("cleave.worker")

# Groups of which many jobs need kernels; edits run in processes of their own.
_OTHERS = ("bodies", "fine", "draw")
_LOG_INTERVAL_S = 5.0  # set by hand
_PAUSE_S = 2.0  # after an error of Redis, which may not be ready yet; set by hand


class WorkerKernels:
    """Compiles the kernels once for all workers and loads them, so that the work-horses have them in memory.

    So do the modules that jobs need, each of which a work-horse would otherwise import again.
    """

    def __init__(self, connection: Redis) -> None:
        self._report = _Report(connection)
        self._compiling: subprocess.Popen[bytes] | None = None
        self._has_others = False

    def load_first(self) -> None:
        """Load what every job needs; if the other kernels must be compiled, begin that in a process of low priority."""
        compile_kernels(FIRST, self._report)
        self._report.end()
        segcore.warm_up(*FIRST)
        load_readers()
        if must_compile():
            self._compiling = _start_compiling()

    def load_others(self) -> bool:
        """Load the other kernels once they are compiled; called after a job, so that the first one need not wait.

        Returns
        -------
        Whether they were loaded now, so that work-horses that are forked before this lack them.
        """
        is_compiling = self._compiling is not None and self._compiling.poll() is None
        if is_compiling or self._has_others:
            return False
        self._has_others = True
        segcore.warm_up(*_OTHERS)
        return True


class _Report:
    """Tells the log and the queue how far the compilation is."""

    def __init__(self, connection: Redis) -> None:
        self._connection = connection
        self._next_line_at = 0.0
        self._silent_until = 0.0
        self._done = -1

    def __call__(self, progress: CompilationProgress) -> None:
        if progress.done == self._done:
            return
        self._done = progress.done
        state = Compilation(progress.done, progress.count)
        if progress.is_own and time.monotonic() >= self._next_line_at:
            log.info("%s", state)
            self._next_line_at = time.monotonic() + _LOG_INTERVAL_S
        self._publish(state)

    def end(self) -> None:
        """Withdraw the state, which may also be one of a worker that was killed."""
        self._publish(None)

    def _publish(self, state: Compilation | None) -> None:
        if time.monotonic() < self._silent_until:
            return
        try:
            publish_compilation(self._connection, state)
        except QueueError:
            self._silent_until = time.monotonic() + _PAUSE_S


def _start_compiling() -> "subprocess.Popen[bytes]":
    return subprocess.Popen(
        [sys.executable, "-P", "-m", "segcore.kernels", "--quiet"],
        stdin=subprocess.DEVNULL,
        env=environment(),
        preexec_fn=partial(die_with_parent, os.getpid()),
    )
