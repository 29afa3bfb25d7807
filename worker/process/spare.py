"""The spare work-horse: the child process for the next job, forked before that job arrives.

A fork copies no memory, so that the first writes of a new child process are slow: each copies a page of its parent. The
spare does that while it waits, and what its worker prepares. It runs one job, like any work-horse.
"""

import json
import logging
import os
import select
from collections.abc import Callable
from contextlib import suppress
from contextvars import Context
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import NoReturn

from worker.process.work_horse import exit_status

log = logging.getLogger("cleave.worker")

# Names of the processes in ps and top, at most 15 characters.
WAITING_NAME, WORKING_NAME = "cleave-spare", "cleave-job"

# A job that arrives so soon finds the spare unprepared: while jobs wait, preparing would take 0.12 s of the processor
# for each, and a job of 20,000 faces takes 0.2 s.
_BUSY_S = 0.1
_TRIES = 3  # to give an order to a spare; one may be killed while it waits
# What a job of 20,000 faces allocates in pieces: with it 7,500 page faults of the job become 2,200, in 18 ms.
_MEMORY_BYTES, _PIECE_BYTES = 36_000_000, 60_000


@dataclass(frozen=True, slots=True)
class Order:
    """The job that a work-horse is to run."""

    job_id: str
    traceparent: str | None = None  # of the request that has submitted it
    folder: str | None = None  # of its local copy; None if the storage of the worker survives a fork


@dataclass(frozen=True, slots=True)
class WorkHorse:
    """A child process that runs a job, or waits for one."""

    pid: int
    pipe: int  # the end to read of a pipe, to which the process writes reports, and which ends with it


@dataclass(frozen=True, slots=True)
class _Waiting:
    work_horse: WorkHorse
    orders: int  # the descriptor of the pipe to it


class SpareWorkHorse:
    """Forks work-horses ahead, one at a time, and gives each an order.

    Parameters
    ----------
    begin : called at once in the child process; it limits the process, and ties it to this one.
    prepare : called in the child process if it has time before its order.
    run : called in the child process with its order and the pipe for its reports, which does not block.
    """

    def __init__(
        self, begin: Callable[[], None], prepare: Callable[[], None], run: Callable[[Order, int], None]
    ) -> None:
        self._begin = begin
        self._prepare = prepare
        self._run = run
        self._waiting: _Waiting | None = None

    def fork_ahead(self) -> None:
        """Fork the next work-horse, unless one waits already; a failure is logged, as the order will try again."""
        try:
            self._ensure()
        except OSError as error:
            log.warning("no work-horse was forked ahead: %s", error)

    def order(self, order: Order) -> WorkHorse:
        """Give an order to the waiting work-horse, or to a new one if it has died.

        Raises
        ------
        OSError
            If no process can be forked, or each one dies at once.
        """
        text = json.dumps(asdict(order)).encode() + b"\n"
        for _ in range(_TRIES):
            waiting = self._ensure()
            self._waiting = None
            try:
                os.write(waiting.orders, text)
            except BrokenPipeError:
                _reap(waiting.work_horse)
                continue
            finally:
                os.close(waiting.orders)
            return waiting.work_horse
        raise ChildProcessError("Every work-horse died before its order.")

    def dismiss(self) -> None:
        """End the waiting work-horse, if there is one."""
        if self._waiting is not None:
            os.close(self._waiting.orders)  # it ends at the end of its orders
            _reap(self._waiting.work_horse)
            self._waiting = None

    def _ensure(self) -> _Waiting:
        if self._waiting is not None and _has_ended(self._waiting.work_horse):
            self.dismiss()
        if self._waiting is None:
            self._waiting = Context().run(self._fork)  # in an empty context: not about the job that runs
        return self._waiting

    def _fork(self) -> _Waiting:
        orders, given = os.pipe()
        pipe, held = os.pipe()
        try:
            pid = os.fork()
        except OSError:
            for descriptor in (orders, given, pipe, held):
                os.close(descriptor)
            raise
        if pid == 0:
            os.close(given)
            os.close(pipe)
            self._live(orders, held)
        os.close(orders)
        os.close(held)
        return _Waiting(WorkHorse(pid, pipe), given)

    def _live(self, orders: int, held: int) -> NoReturn:
        """Wait for an order and run it; the process ends here."""
        status = os.EX_SOFTWARE
        try:
            os.set_blocking(held, False)
            os.setpgrp()  # signals to the group of the worker do not end it
            _rename(WAITING_NAME)
            self._begin()
            if not select.select([orders], [], [], _BUSY_S)[0]:
                self._prepare()
                _touch_memory()
            text = _read_line(orders)
            _rename(WORKING_NAME)
            status = exit_status(lambda: self._run(Order(**json.loads(text)), held)) if text else os.EX_OK
        finally:
            os._exit(status)


def _touch_memory() -> None:
    """Write to the memory that a job will allocate, and free it."""
    with suppress(MemoryError):
        [b"\1" * _PIECE_BYTES for _ in range(_MEMORY_BYTES // _PIECE_BYTES)]


def _read_line(descriptor: int) -> bytes:
    """Return a line; empty if the pipe ends, as the worker is gone."""
    text = b""
    while not text.endswith(b"\n"):
        piece = os.read(descriptor, 4096)
        if not piece:
            return b""
        text += piece
    return text


def _rename(name: str) -> None:
    with suppress(OSError):  # systems other than Linux
        Path("/proc/self/comm").write_text(name)


def _has_ended(work_horse: WorkHorse) -> bool:
    return bool(select.select([work_horse.pipe], [], [], 0)[0])


def _reap(work_horse: WorkHorse) -> None:
    os.close(work_horse.pipe)
    with suppress(ChildProcessError):
        os.waitpid(work_horse.pid, 0)
