"""The supervisor of the processes of an installation: starts, restarts and stops them."""

import fcntl
import logging
import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import FrameType
from typing import BinaryIO

from cleave.parent_death import die_with_parent

log = logging.getLogger("cleave.supervisor")

# Set by hand. A process that cannot start is retried every 10 s at most, and one that crashes is back in half a second.
_POLL_S = 0.1
_FIRST_DELAY_S = 0.5  # of a restart; each further one is twice as long
_MAX_DELAY_S = 10.0
_STABLE_S = 5.0  # after so long a run, the delay of the next restart is the first one again


class DataInUse(Exception):  # noqa: N818
    """Another supervisor uses the data folder; the message contains its process id."""


@dataclass(frozen=True, slots=True)
class Program:
    """A process to keep running."""

    name: str
    command: list[str]
    environment: dict[str, str] = field(default_factory=dict)  # in addition to the environment of the supervisor
    descriptors: tuple[int, ...] = ()  # open files that it inherits
    grace_s: float = 5.0  # from SIGTERM to SIGKILL; set by hand
    is_support: bool = False  # stopped after the others, which need it while they stop
    starts_after: Callable[[], bool] | None = None  # started once this returns True; at once if it is None
    on_end: Callable[[int], None] | None = None  # called with the exit status before a restart, if it ended by itself


class Supervisor:
    """Starts programs, restarts those that end, and stops them all on SIGINT or SIGTERM; a second signal kills them.

    Signals count from the making of the supervisor, which belongs, as ``run``, in the main thread.
    """

    def __init__(self, programs: Iterable[Program]) -> None:
        self._children = [_Child(program) for program in programs]
        self._signals = 0
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._count_signal)

    def run(self) -> None:
        """Run the programs until a signal arrives, and return when every process has ended.

        Call it from the main thread: the kernel kills the children when the thread that started them ends.
        """
        try:
            while not self._signals:
                for child in self._children:
                    child.keep_running()
                time.sleep(_POLL_S)
            self._stop([child for child in self._children if not child.program.is_support])
            self._stop(self._children)
        finally:
            for child in self._children:
                child.kill()

    def _count_signal(self, number: int, frame: FrameType | None) -> None:  # noqa: ARG002
        self._signals += 1

    def _stop(self, children: list["_Child"]) -> None:
        for child in children:
            child.terminate()
        stopped_at = time.monotonic()
        while any(child.is_running() for child in children) and self._signals < 2:
            for child in children:
                if time.monotonic() > stopped_at + child.program.grace_s:
                    child.kill()
            time.sleep(_POLL_S)
        for child in children:
            child.kill()


class _Child:
    """A program and its current process."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self._process: subprocess.Popen[bytes] | None = None
        self._started_at = 0.0
        self._delay_s = _FIRST_DELAY_S
        self._start_at = 0.0

    def keep_running(self) -> None:
        if self._process is not None and self._process.poll() is not None:
            self._schedule_restart(self._process.returncode)
        if self._process is None and time.monotonic() >= self._start_at and self._may_start():
            self._start()

    def _may_start(self) -> bool:
        return self.program.starts_after is None or self.program.starts_after()

    def is_running(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def terminate(self) -> None:
        if self._process is not None and self.is_running():
            self._process.terminate()

    def kill(self) -> None:
        if self._process is not None and self.is_running():
            self._process.kill()
            self._process.wait()

    def _start(self) -> None:
        # In its own process group, so that Ctrl-C at a terminal sends SIGINT to the supervisor only.
        self._process = subprocess.Popen(
            self.program.command,
            env=os.environ | self.program.environment,
            stdin=subprocess.DEVNULL,
            pass_fds=self.program.descriptors,
            process_group=0,
            preexec_fn=partial(die_with_parent, os.getpid()),
        )
        self._started_at = time.monotonic()

    def _schedule_restart(self, status: int) -> None:
        self._process = None
        if self.program.on_end is not None:
            self.program.on_end(status)
        ran_s = time.monotonic() - self._started_at
        self._delay_s = _FIRST_DELAY_S if ran_s > _STABLE_S else min(2 * self._delay_s, _MAX_DELAY_S)
        self._start_at = time.monotonic() + self._delay_s
        reason = signal.Signals(-status).name if status < 0 else f"status {status}"
        log.warning("the %s ended with %s and is restarted in %.1f s", self.program.name, reason, self._delay_s)


def lock_data(data_dir: Path) -> BinaryIO:
    """Lock a data folder for this process, until the returned file is closed or the process ends.

    Raises
    ------
    DataInUse
        If another process has locked it.
    """
    data_dir.mkdir(mode=0o700, parents=True, exist_ok=True)
    file = (data_dir / "serve.lock").open("a+b")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        file.seek(0)
        holder = file.read(32).decode("ascii", "replace").strip()
        file.close()
        raise DataInUse(
            f"Process {holder} uses the data folder {data_dir}: stop it, or choose another folder with --data-dir."
        ) from error
    file.truncate(0)
    with suppress(OSError):  # the process id is only for the message: the lock holds without it
        file.write(f"{os.getpid()}\n".encode())
        file.flush()
    return file
