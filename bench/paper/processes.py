"""The same work on many items, in several processes of one thread each."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context
from typing import TypeVar

from bench.errors import BenchmarkError
from bench.pool import THREAD_SETTINGS

Item = TypeVar("Item")
Result = TypeVar("Result")


def in_processes(
    work: Callable[[Item], Result], items: Sequence[Item], jobs: int, warm_up: Callable[[], None]
) -> list[Result]:
    """The results of all items, in their order.

    Parameters
    ----------
    work, warm_up : picklable; every process calls ``warm_up`` before its first item.

    Raises
    ------
    BenchmarkError
        Where the work on one item raises it, or a process dies.
    """
    with one_thread():
        pool = ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_start, initargs=(warm_up,))
        try:
            futures = [pool.submit(work, item) for item in items]
            for done, future in enumerate(as_completed(futures), start=1):
                future.result()
                _show_progress(done, len(items))
            return [future.result() for future in futures]
        except BrokenProcessPool as error:
            raise BenchmarkError("A process of the benchmark ended early: look for its message above.") from error
        finally:
            pool.shutdown(cancel_futures=True)


@contextmanager
def one_thread() -> Iterator[None]:
    """Let processes started in here have one thread, whatever the environment says: their times are compared."""
    before = {name: os.environ.get(name) for name in THREAD_SETTINGS}
    os.environ.update(dict.fromkeys(THREAD_SETTINGS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _start(warm_up: Callable[[], None]) -> None:
    # Ctrl-C reaches all processes of a terminal: the first one ends the others, which have nothing to add.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warm_up()


def _show_progress(done: int, total: int) -> None:
    if sys.stderr.isatty():
        print(f"\r{done} of {total} models", end="\n" if done == total else "", file=sys.stderr, flush=True)
