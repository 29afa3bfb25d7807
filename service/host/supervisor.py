"""A process that keeps others running, and leaves none behind."""

import fcntl
import logging
import os
import signal
import subprocess
import time
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import FrameType
from typing import BinaryIO

from cleave.parent_death import die_with_parent

log = logging.getLogger("cleave.supervisor")

_TICK_S = 0.1
_FIRST_PAUSE_S = 0.5  # between the death of a process and its restart; doubles as long as it keeps dying
_LONGEST_PAUSE_S = 10.0
_SETTLED_S = 5.0  # a process that ran for so long has not failed to start


class DataInUse(Exception):  # noqa: N818
    """Another supervisor has the data folder; the message says which."""


@dataclass(frozen=True, slots=True)
class Program:
    """What is to be kept running."""

    name: str
    command: list[str]
    environment: dict[str, str] = field(default_factory=dict)  # added to this process's own
    descriptors: tuple[int, ...] = ()  # open files that it inherits
    grace_s: float = 5.0  # from the request to stop until it is killed
    is_support: bool = False  # the others need it, also while they stop


class Supervisor:
    """Starts programs, restarts those that die, and on SIGINT or SIGTERM stops them all; a second signal hurries."""

    def __init__(self, programs: Iterable[Program]) -> None:
        self._children = [_Child(program) for program in programs]
        self._signals = 0

    def run(self) -> None:
        """Return when a signal has come and every process has ended.

        To be called from the main thread: the kernel ends the children with the thread that started them.
        """
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._take_signal)
        try:
            while not self._signals:
                for child in self._children:
                    child.keep_running()
                time.sleep(_TICK_S)
            self._stop([child for child in self._children if not child.program.is_support])
            self._stop(self._children)
        finally:
            for child in self._children:
                child.kill()

    def _take_signal(self, number: int, frame: FrameType | None) -> None:  # noqa: ARG002
        self._signals += 1

    def _stop(self, children: list["_Child"]) -> None:
        for child in children:
            child.ask_to_stop()
        asked_at = time.monotonic()
        while any(child.is_running() for child in children) and self._signals < 2:
            for child in children:
                if time.monotonic() > asked_at + child.program.grace_s:
                    child.kill()
            time.sleep(_TICK_S)
        for child in children:
            child.kill()


class _Child:
    """One program and the process that runs it at the moment."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self._process: subprocess.Popen[bytes] | None = None
        self._started_at = 0.0
        self._pause_s = _FIRST_PAUSE_S
        self._start_at = 0.0

    def keep_running(self) -> None:
        if self._process is not None and self._process.poll() is not None:
            self._note_death(self._process.returncode)
        if self._process is None and time.monotonic() >= self._start_at:
            self._start()

    def is_running(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def ask_to_stop(self) -> None:
        if self._process is not None and self.is_running():
            self._process.terminate()

    def kill(self) -> None:
        if self._process is not None and self.is_running():
            self._process.kill()
            self._process.wait()

    def _start(self) -> None:
        # A group of its own, so that Ctrl-C at a terminal reaches the supervisor alone.
        self._process = subprocess.Popen(
            self.program.command,
            env=os.environ | self.program.environment,
            stdin=subprocess.DEVNULL,
            pass_fds=self.program.descriptors,
            process_group=0,
            preexec_fn=partial(die_with_parent, os.getpid()),
        )
        self._started_at = time.monotonic()

    def _note_death(self, status: int) -> None:
        self._process = None
        lived_s = time.monotonic() - self._started_at
        self._pause_s = _FIRST_PAUSE_S if lived_s > _SETTLED_S else min(2 * self._pause_s, _LONGEST_PAUSE_S)
        self._start_at = time.monotonic() + self._pause_s
        reason = signal.Signals(-status).name if status < 0 else f"status {status}"
        log.warning("the %s ended with %s and is started again in %.1f s", self.program.name, reason, self._pause_s)


def lock_data(data_dir: Path) -> BinaryIO:
    """Claim a data folder for this process; the claim ends with the returned file, or with the process.

    Raises
    ------
    DataInUse
        Where another process has claimed it.
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
            f"Process {holder} serves the data in {data_dir}: stop it, or choose another folder with --data-dir."
        ) from error
    file.truncate(0)
    with suppress(OSError):  # the number is for people; the claim stands without it
        file.write(f"{os.getpid()}\n".encode())
        file.flush()
    return file
