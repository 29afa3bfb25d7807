"""Learned models that ship as a data file of this package, and that others can replace for a while."""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from importlib.resources import files
from typing import Any, Generic, TypeVar

Models = TypeVar("Models")


class Shipped(Generic[Models]):
    """The models of a data file, which is read at first use.

    Parameters
    ----------
    file_name : a JSON file of this package.
    from_document : makes the models of its content.
    """

    def __init__(self, file_name: str, from_document: Callable[[Mapping[str, Any]], Models]) -> None:
        self._file_name = file_name
        self._from_document = from_document
        self._override: ContextVar[Models | None] = ContextVar(file_name, default=None)
        self._shipped: Models | None = None

    def current(self) -> Models:
        """The models of the data file, or those of an enclosing ``using``."""
        override = self._override.get()
        if override is not None:
            return override
        if self._shipped is None:
            text = files("segcore.learned").joinpath(self._file_name).read_text("utf-8")
            self._shipped = self._from_document(json.loads(text))
        return self._shipped

    @contextmanager
    def using(self, models: Models) -> Iterator[None]:
        """Context manager that replaces the models, to train them or to evaluate them on shapes they have not seen."""
        token = self._override.set(models)
        try:
            yield
        finally:
            self._override.reset(token)
