"""The learned choices between candidates that ship with the package."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from segcore.arrays import FloatArray
from segcore.learned.shipped import Shipped


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


_SHIPPED = Shipped("choices.json", ChoiceModels.from_document)
choice_models = _SHIPPED.current
using_choices = _SHIPPED.using
