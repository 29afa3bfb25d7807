"""An executor that stands for the processes of the benchmarks and runs in this process, which has the kernels."""

import pickle
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any


class InThisProcess:
    """Runs functions at once; what they take and return is pickled, as on the way to a process and back."""

    def __init__(self, *_: object, **__: object) -> None:
        pass

    def submit(self, function: Callable[[Any], Any], item: object) -> "Future[Any]":
        called, argument = pickle.loads(pickle.dumps((function, item)))
        future: Future[Any] = Future()
        try:
            future.set_result(pickle.loads(pickle.dumps(called(argument))))
        except Exception as error:
            future.set_exception(error)
        return future

    def shutdown(self, **_: object) -> None:
        pass
