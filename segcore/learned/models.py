"""The learned models that ship with the package."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from segcore.learned.logistic import LogisticModel


@dataclass(frozen=True, slots=True, eq=False)
class LearnedModels:
    """What ``python -m bench train`` has learned."""

    boundary: LogisticModel  # of a cut along an edge, see segcore.affinity.boundary_features
    split: LogisticModel  # of what people keep together across a cut, see segcore.cut.features

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> "LearnedModels":
        """The inverse of ``document``."""
        return cls(LogisticModel.from_document(document["boundary"]), LogisticModel.from_document(document["split"]))

    def document(self) -> dict[str, Any]:
        """The models as plain values for JSON."""
        return {"boundary": self.boundary.document(), "split": self.split.document()}


_instead: ContextVar[LearnedModels | None] = ContextVar("learned models", default=None)


def learned_models() -> LearnedModels:
    """The models of the data file models.json in this package, or those given with ``using``."""
    return _instead.get() or _shipped()


@contextmanager
def using(models: LearnedModels) -> Iterator[None]:
    """Let everything inside go by other models: to train them, and to judge them on shapes that they have not seen."""
    token = _instead.set(models)
    try:
        yield
    finally:
        _instead.reset(token)


@cache
def _shipped() -> LearnedModels:
    return LearnedModels.from_document(json.loads(files("segcore.learned").joinpath("models.json").read_text("utf-8")))
