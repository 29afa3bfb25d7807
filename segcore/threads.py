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
from functools import partial
from typing import Any, TypeVar

from segcore.arrays import FloatArray

BLOCK = 1 << 16  # items in a block: some milliseconds of work; set by hand
MANY_FACES = 200_000  # from which on a segmentation gets all free cores by default; set by hand

_Result = TypeVar("_Result")

_pool: ContextVar[ThreadPoolExecutor | None] = ContextVar("_pool", default=None)


@contextmanager
def use_threads(count: int) -> Iterator[None]:
    """Let the calls inside a ``with`` statement use a number of threads, at least 1.

    The threads are made here, and so in the process that uses them, and end with the statement.
    """
    if count <= 1:
        yield
        return
    with ThreadPoolExecutor(count, "segcore") as pool:
        token = _pool.set(pool)
        try:
            yield
        finally:
            _pool.reset(token)
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
    blocks = [(start, min(start + BLOCK, count)) for start in range(0, count, BLOCK)]
    pool = _pool.get()
    if pool is None or len(blocks) == 1:
        for start, end in blocks:
            kernel(start, end, *arguments)
        return
    for done in [pool.submit(kernel, start, end, *arguments) for start, end in blocks]:
        done.result()


def sums_of_blocks(kernel: Callable[..., FloatArray], count: int, *arguments: object, groups: int = 0) -> FloatArray:
    """The sum of the arrays ``kernel(start, end, *arguments)`` of all blocks, in their order.

    Parameters
    ----------
    count : number of items, at least 1.
    groups : rows of the arrays; blocks are at least 16 times as large.
    """
    size = max(BLOCK, 16 * groups)
    blocks = [(start, min(start + size, count)) for start in range(0, count, size)]
    pool = _pool.get()
    if pool is None or len(blocks) == 1:
        parts: Iterator[FloatArray] = (kernel(start, end, *arguments) for start, end in blocks)
    else:
        begun = [pool.submit(kernel, start, end, *arguments) for start, end in blocks]
        parts = (done.result() for done in begun)
    total = next(parts)
    for part in parts:
        total = total + part
    return total


def meanwhile(function: Callable[..., _Result], *arguments: Any) -> Callable[[], _Result]:
    """Begin a call in another thread if there are several; return a function that waits for its result.

    The call uses one thread.
    """
    pool = _pool.get()
    if pool is None:
        return partial(function, *arguments)
    return pool.submit(copy_context().run, _alone, function, *arguments).result


def _alone(function: Callable[..., _Result], *arguments: object) -> _Result:
    _pool.set(None)
    return function(*arguments)
