"""Threads for one segmentation, whose number does not change a result.

Kernels that are compiled with ``nogil=True`` run over blocks of faces, edges or vertices. The blocks do not depend on
the number of threads, each is computed by one thread, and sums over blocks are added in the order of the blocks.
Threads of numba are not used: they would be compiled apart and do not survive the fork of a work-horse.
"""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar, copy_context
from dataclasses import dataclass
from functools import partial, reduce
from typing import Any, TypeVar

import numpy as np

from segcore.arrays import FloatArray

BLOCK = 1 << 16  # items in a block: some milliseconds of work; set by hand
MANY_FACES = 200_000  # from which on a segmentation gets all free cores by default; set by hand

_Result = TypeVar("_Result")


@dataclass(frozen=True, slots=True)
class _Helpers:
    """The threads beside the one that calls."""

    count: int
    pool: ThreadPoolExecutor


_helpers: ContextVar[_Helpers | None] = ContextVar("_helpers", default=None)


@contextmanager
def use_threads(count: int) -> Iterator[None]:
    """Let the calls inside a ``with`` statement use a number of threads, at least 1, with the one that calls.

    The other threads are made here, and so in the process that uses them, and end with the statement.
    """
    if count <= 1:
        yield
        return
    with ThreadPoolExecutor(count - 1, "segcore") as pool:
        token = _helpers.set(_Helpers(count - 1, pool))
        try:
            yield
        finally:
            _helpers.reset(token)
            pool.shutdown(cancel_futures=True)


def default_threads(face_count: int) -> int:
    """The number of threads for a mesh if none is given: 1 for a small one, for others the cores that are free now."""
    if face_count < MANY_FACES:
        return 1
    busy = round(os.getloadavg()[0]) if hasattr(os, "getloadavg") else 0
    return max(1, usable_cores() - busy)


def usable_cores() -> int:
    """The number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def in_blocks(kernel: Callable[..., object], count: int, *arguments: object) -> None:
    """Call ``kernel(start, end, *arguments)`` for consecutive blocks of 0..count - 1, in the threads in use.

    Parameters
    ----------
    kernel : compiled with ``nogil=True``; writes only to the items of its block.
    """
    _each(lambda start, end, _: kernel(start, end, *arguments), count, BLOCK)


def sums_of_blocks(kernel: Callable[..., FloatArray], count: int, *arguments: object, groups: int = 0) -> FloatArray:
    """The sum of the arrays ``kernel(start, end, *arguments)`` of all blocks, in their order.

    Parameters
    ----------
    count : number of items, at least 1.
    groups : rows of the arrays; blocks are at least 16 times as large.
    """
    size = max(BLOCK, 16 * groups)
    parts: list[FloatArray] = [np.empty(0)] * -(-count // size)

    def add(start: int, end: int, number: int) -> None:
        parts[number] = kernel(start, end, *arguments)

    _each(add, count, size)
    return reduce(np.add, parts)


def _each(work: Callable[[int, int, int], object], count: int, size: int) -> None:
    """Call ``work(start, end, number)`` for every block. Threads take the next block when they have done one."""
    blocks = iter([(start, min(start + size, count), number) for number, start in enumerate(range(0, count, size))])

    def take() -> None:
        for block in blocks:  # each is given to one thread: the iterator of a list is not interrupted
            work(*block)

    helpers = _helpers.get()
    helping = [helpers.pool.submit(take) for _ in range(helpers.count)] if helpers and count > size else []
    take()
    for one in helping:
        if not one.cancel():  # a thread that is still at other work has not begun, and there is nothing left to do
            one.result()


def meanwhile(function: Callable[..., _Result], *arguments: Any) -> Callable[[], _Result]:
    """Begin a call in another thread if there are several; return a function that returns its result.

    The call uses one thread. If no thread has begun with it, the function makes the call itself.
    """
    helpers = _helpers.get()
    if helpers is None:
        return partial(function, *arguments)
    begun = helpers.pool.submit(copy_context().run, _alone, function, *arguments)
    return lambda: function(*arguments) if begun.cancel() else begun.result()


def _alone(function: Callable[..., _Result], *arguments: Any) -> _Result:
    _helpers.set(None)
    return function(*arguments)
