"""``python -m segcore.kernels.recording``: write the list of kernels, from what small tasks of each group call."""

import subprocess
import sys
from collections.abc import Iterator

from numba.core.registry import CPUDispatcher

from segcore.kernels.manifest import GROUPS, Kernel, write_kernels
from segcore.kernels.signatures import encode
from segcore.kernels.tasks import warm_up


def recorded() -> list[Kernel]:
    """Return the kernels that the tasks of :func:`segcore.warm_up` call, sorted by group and name.

    Call it in a process that has called no kernel, after another one has compiled all of them: kernels that a kernel
    calls are loaded with it, so that exactly those that Python calls are loaded from the cache by themselves.
    """
    found: list[Kernel] = []
    known: set[tuple[str, str]] = set()
    for group in GROUPS:
        warm_up(group)
        new = [kernel for kernel in called(group) if _name(kernel) not in known]
        known.update(map(_name, new))
        found += sorted(new, key=_name)
    return found


def _name(kernel: Kernel) -> tuple[str, str]:
    return kernel.place, str(kernel.arguments)


def called(group: str) -> Iterator[Kernel]:
    """Yield the kernels that this process has loaded from the cache, as ones of a group."""
    for place, kernel in _all_kernels():
        for types in kernel.stats.cache_hits:
            yield Kernel(group, place, [encode(kind) for kind in types], _size(kernel, set()))


def _all_kernels() -> Iterator[tuple[str, CPUDispatcher]]:
    """Yield every kernel of the imported modules of the package, and its place."""
    for module in [module for name, module in sys.modules.items() if name.startswith("segcore.")]:
        for name, value in vars(module).items():
            if isinstance(value, CPUDispatcher) and value.py_func.__module__ == module.__name__:
                yield f"{module.__name__}:{name}", value


def _size(kernel: CPUDispatcher, seen: set[str]) -> int:
    """Return the bytes of the bytecode of a kernel and of those that it calls, directly or not."""
    function = kernel.py_func
    seen.add(f"{function.__module__}:{function.__qualname__}")
    names = (function.__globals__.get(name) for name in function.__code__.co_names)
    called = [value for value in names if isinstance(value, CPUDispatcher)]
    inner = sum(
        _size(value, seen) for value in called if f"{value.py_func.__module__}:{value.py_func.__qualname__}" not in seen
    )
    return len(function.__code__.co_code) + inner


def main() -> None:
    """Write the list. A child process compiles the kernels first."""
    subprocess.run([sys.executable, "-c", "import segcore; segcore.warm_up()"], check=True)
    write_kernels(recorded())


if __name__ == "__main__":
    main()
