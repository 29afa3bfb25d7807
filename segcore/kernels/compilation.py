"""Compilation of groups of kernels, once for all processes that use the same cache."""

import logging
from collections import Counter
from collections.abc import Callable, Collection
from dataclasses import replace
from typing import TypeAlias

from segcore.kernels.manifest import GROUPS, Kernel, kernels
from segcore.kernels.place import CompilationProgress, KernelPlace, kernel_place
from segcore.kernels.processes import compile_in_processes
from segcore.threads import usable_cores

OnProgress: TypeAlias = Callable[[CompilationProgress], object]

log = logging.getLogger("segcore")

# More would save little, as the largest kernel takes an eighth of the time of all; each needs up to 500 MB.
_MOST_PROCESSES = 4


def must_compile(groups: Collection[str] = GROUPS) -> bool:
    """Whether kernels of some groups are not in the cache; False if every process compiles its own."""
    place = kernel_place()
    return place is not None and not place.groups() >= frozenset(groups)


def compile_kernels(
    groups: Collection[str] = GROUPS, on_progress: OnProgress = lambda _: None, *, niceness: int = 0
) -> None:
    """Compile groups of kernels into numba's cache, in parallel, unless they are there.

    If another process compiles, wait until the groups are complete; if it ends before that, go on in its place.
    Kernels that cannot be compiled here are compiled by the process that calls them. No kernel is loaded.

    Parameters
    ----------
    groups : names of ``GROUPS``.
    on_progress : called each time a kernel is done, and repeatedly while another process compiles.
    niceness : added to that of the processes that compile.
    """
    place = kernel_place()
    wanted = frozenset(groups)
    if place is None or place.groups() >= wanted:
        return

    def is_done() -> bool:
        if place.groups() >= wanted:
            return True
        progress = place.progress()
        if progress is not None:
            on_progress(replace(progress, is_own=False))
        return False

    with place.locked(is_done) as is_mine:
        if is_mine:
            _compile(place, wanted - place.groups(), on_progress, niceness)


def _compile(place: KernelPlace, groups: frozenset[str], on_progress: OnProgress, niceness: int) -> None:
    chosen = [kernel for kernel in kernels() if kernel.group in groups]
    left = Counter(kernel.group for kernel in chosen)
    complete = place.groups()

    def report() -> None:
        progress = CompilationProgress(len(chosen) - left.total(), len(chosen))
        place.write(complete | {group for group in groups if not left[group]}, progress)
        on_progress(progress)

    def note(kernel: Kernel) -> None:
        left[kernel.group] -= 1
        report()

    report()
    if not compile_in_processes(chosen, _processes(), niceness, note):
        log.warning("the processes that compile kernels have ended early: kernels are compiled when they are called")


def _processes() -> int:
    return min(usable_cores(), _MOST_PROCESSES)
