"""Counts what a store asks of its storage."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from worker.jobs.objects import local


class Counted:
    """The calls of a folder's storage, and the names that it reads from the disk."""

    def __init__(self) -> None:
        self.calls = 0
        self.names = 0

    def total(self) -> int:
        return self.calls + self.names


def counting(monkeypatch: pytest.MonkeyPatch) -> Counted:
    """Count from now on, until the end of the test."""
    counted = Counted()
    methods = [name for name in vars(local.LocalObjects) if not name.startswith("_") and name != "each"]
    for name in methods:
        method = getattr(local.LocalObjects, name)
        if callable(method):
            monkeypatch.setattr(local.LocalObjects, name, _counted(counted, method))
    names = local._names

    def counted_names(path: Path) -> Iterator[str]:
        for name in names(path):
            counted.names += 1
            yield name

    monkeypatch.setattr(local, "_names", counted_names)
    return counted


def _counted(counted: Counted, method: Any) -> Any:
    def call(*given: object, **named: object) -> object:
        counted.calls += 1
        return method(*given, **named)

    return call
