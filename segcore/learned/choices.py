"""The learned choices between candidates that ship with the package."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from segcore.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class ChoiceModel:
    """The conditional logit: candidate i is right with a probability in proportion to exp(w . (x_i - mean) / scale).

    References
    ----------
    McFadden, Conditional logit analysis of qualitative choice behavior, 1974.
    """

    names: tuple[str, ...]  # of the M features
    mean: FloatArray  # (M,)
    scale: FloatArray  # (M,) > 0
    weight: FloatArray  # (M,)

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> "ChoiceModel":
        """The inverse of ``document``."""
        mean, scale, weight = (np.array(document[key], dtype=np.float64) for key in ("mean", "scale", "weight"))
        return cls(tuple(document["features"]), mean, scale, weight)

    def document(self) -> dict[str, Any]:
        """The model as plain values for JSON."""
        return {
            "features": list(self.names),
            "mean": self.mean.tolist(),
            "scale": self.scale.tolist(),
            "weight": self.weight.tolist(),
        }

    def log_probability(self, features: FloatArray) -> FloatArray:
        """(C,) <= 0, of the features (C, M) of all candidates of one choice."""
        score = ((features - self.mean) / self.scale * self.weight).sum(axis=1)
        score -= score.max()
        logarithm: FloatArray = score - np.log(np.exp(score).sum())
        return logarithm


@dataclass(frozen=True, slots=True, eq=False)
class ChoiceModels:
    """The models that ``python -m bench clicks --train`` fits."""

    part: ChoiceModel  # the node of a hierarchy that a person means who marks a face, see segcore.edit.tree_parts
    correction: ChoiceModel  # the change that a person means who marks a wrong face, see segcore.edit.corrections

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> "ChoiceModels":
        """The inverse of ``document``."""
        return cls(ChoiceModel.from_document(document["part"]), ChoiceModel.from_document(document["correction"]))

    def document(self) -> dict[str, Any]:
        """The models as plain values for JSON."""
        return {"part": self.part.document(), "correction": self.correction.document()}


_override: ContextVar[ChoiceModels | None] = ContextVar("choice models", default=None)


def choice_models() -> ChoiceModels:
    """The models of the data file choices.json in this package, or those of an enclosing ``using_choices``."""
    return _override.get() or _shipped()


@contextmanager
def using_choices(models: ChoiceModels) -> Iterator[None]:
    """Context manager that replaces the models, to train them or to evaluate them on shapes they have not seen."""
    token = _override.set(models)
    try:
        yield
    finally:
        _override.reset(token)


@cache
def _shipped() -> ChoiceModels:
    return ChoiceModels.from_document(json.loads(files("segcore.learned").joinpath("choices.json").read_text("utf-8")))
