"""Compilation of kernels in several processes, each of which compiles one after another."""

import os
import selectors
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import IO

from segcore.kernels.manifest import GROUPS, Kernel, kernels

_ROOT = Path(__file__).parents[2]


def environment() -> dict[str, str]:
    """Return the variables of a process that imports this package, also if it is run from a checkout."""
    return os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, [str(_ROOT), os.environ.get("PYTHONPATH")]))}


def compile_in_processes(
    chosen: Sequence[Kernel], count: int, niceness: int, on_done: Callable[[Kernel], None]
) -> bool:
    """Compile kernels into the cache, group by group, those that take longest first.

    The processes end when this one does, however that happens. Return False if all of them ended too early, for example
    because they were killed.
    """
    order = sorted(chosen, key=lambda kernel: (GROUPS.index(kernel.group), -kernel.size))
    with ExitStack() as stack:
        children = [_Child(niceness, stack) for _ in range(min(count, len(order)))]
        selector = stack.enter_context(selectors.DefaultSelector())
        for child in children:
            selector.register(child.answers, selectors.EVENT_READ, child)
            child.next(order)
        while selector.get_map():
            for key, _ in selector.select():
                child = key.data
                kernel = child.compiled()
                if kernel is not None:
                    on_done(kernel)
                if kernel is None or not child.next(order):
                    selector.unregister(child.answers)
    return not order and all(child.has_finished for child in children)


class _Child:
    """A process and the kernel that it compiles now."""

    def __init__(self, niceness: int, stack: ExitStack) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "segcore.kernels.compiler", str(niceness)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            bufsize=0,
            env=environment(),
        )
        stack.callback(self._process.wait)
        stack.callback(self._process.kill)
        assert self._process.stdin
        assert self._process.stdout
        self._orders: IO[bytes] = stack.enter_context(self._process.stdin)
        self.answers: IO[bytes] = stack.enter_context(self._process.stdout)
        self._kernel: Kernel | None = None

    @property
    def has_finished(self) -> bool:
        """Whether it has compiled all that it was given."""
        return self._kernel is None

    def next(self, order: list[Kernel]) -> bool:
        """Take the first kernel of a list; False if there is none."""
        self._kernel = order.pop(0) if order else None
        if self._kernel is None:
            return False
        with suppress(BrokenPipeError):  # the end of its answers is noticed as well
            self._orders.write(b"%d\n" % kernels().index(self._kernel))
        return True

    def compiled(self) -> Kernel | None:
        """Return the kernel that is compiled now; None if the process has ended."""
        return self._kernel if self.answers.readline() else None
