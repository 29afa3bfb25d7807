"""The decorators of kernels. All have the same options, so that numba's own functions are compiled for them once.

Kernels release the global interpreter lock. A division by zero in one gives an infinity or NaN and no exception.
"""

from collections.abc import Callable
from typing import Any, NoReturn

from numba import njit
from numba.core.registry import CPUDispatcher

from segcore.lazy import import_later

import_later("numpy.f2py")  # SciPy, which numba imports, takes all names of numpy: this one needs 0.1 s

_OPTIONS = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}

kernel = njit(cache=True, **_OPTIONS)
inlined_kernel = njit(cache=True, inline="always", **_OPTIONS)


class _InnerDispatcher(CPUDispatcher):  # type: ignore[misc]
    def __call__(self, *_: object) -> NoReturn:
        """Refuse the call, as there is no compiled code that takes Python objects; numba itself would crash."""
        raise TypeError(f"{self.py_func.__qualname__} is called by kernels alone: use the decorator kernel")


def inner_kernel(function: Callable[..., Any]) -> CPUDispatcher:
    """Compile a function that kernels alone call. Half the time that a small one takes is spared."""
    inner = _InnerDispatcher(function, targetoptions={**_OPTIONS, "nopython": True, "no_cpython_wrapper": True})
    inner.enable_caching()
    return inner
