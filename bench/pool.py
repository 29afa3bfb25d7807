"""Runs a function on many models in several processes of one thread each."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context
from typing import TypeVar

from bench.errors import BenchmarkError

Item = TypeVar("Item")
Result = TypeVar("Result")

# The variables from which numerical libraries read their number of threads when they are loaded.
THREAD_SETTINGS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")

# Groups of ``segcore.kernels.GROUPS``: the kernels of segmentations with the default parameters, which take half of the
# time that all need to be loaded.
OF_SEGMENTATIONS = ("segment", "bodies", "fine")


def map_in_processes(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int, warm_up: Callable[[], None]
) -> list[Result]:
    """Return the results of a function for all items, in their order.

    CPU times do not depend on the number of processes: each of them is warmed up before its first item, and its
    numerical libraries use one thread unless the environment sets another number.

    Parameters
    ----------
    function, warm_up : picklable.
    jobs : number of processes.

    Raises
    ------
    BenchmarkError
        If the function raises it, or a process dies.
    """
    with one_thread_by_default():
        pool = ProcessPoolExecutor(
            jobs, mp_context=get_context("spawn"), initializer=_start_process, initargs=(warm_up,)
        )
        try:
            return _in_order(pool, function, items)
        except BrokenProcessPool as error:
            raise BenchmarkError("A process of the benchmark ended early: look for its message above.") from error
        finally:
            pool.shutdown(cancel_futures=True)


@contextmanager
def one_thread_by_default() -> Iterator[None]:
    """Start processes with one thread per numerical library, unless the environment sets another number."""
    with _environment({name: "1" for name in THREAD_SETTINGS if name not in os.environ}):
        yield


@contextmanager
def one_thread() -> Iterator[None]:
    """Start processes with one thread per numerical library, even if the environment sets another number."""
    with _environment(dict.fromkeys(THREAD_SETTINGS, "1")):
        yield


@contextmanager
def _environment(variables: Mapping[str, str]) -> Iterator[None]:
    """Set environment variables, and restore them at the end."""
    before = {name: os.environ.get(name) for name in variables}
    os.environ.update(variables)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _start_process(warm_up: Callable[[], None]) -> None:
    # Ctrl-C reaches all processes of a terminal; the parent process ends the others.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warm_up()


def _in_order(pool: ProcessPoolExecutor, function: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
    futures = [pool.submit(function, item) for item in items]
    for done, future in enumerate(as_completed(futures), start=1):
        future.result()
        _show_progress(done, len(items))
    return [future.result() for future in futures]


def _show_progress(done: int, total: int) -> None:
    if sys.stderr.isatty():
        print(f"\r{done} of {total} models", end="\n" if done == total else "", file=sys.stderr, flush=True)
