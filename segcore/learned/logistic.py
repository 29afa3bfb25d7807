"""Logistic regression on standardised features, their squares and hinges."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from segcore.arrays import FloatArray
from segcore.jit.decorators import kernel

CLIP = 4.0  # standard deviations at which features are clipped: a limit on extrapolation, set by hand
_HINGE = 1.0  # standard deviations at which the hinges begin; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class LogisticModel:
    """p = 1 / (1 + exp(-(bias + w . basis((x - mean) / scale))))."""

    names: tuple[str, ...]  # of the M features
    mean: FloatArray  # (M,)
    scale: FloatArray  # (M,) > 0
    weight: FloatArray  # (4 M,) of the functions of ``basis``
    bias: float

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> "LogisticModel":
        """The inverse of ``document``."""
        names = tuple(document["features"])
        mean, scale, weight = (np.array(document[key], dtype=np.float64) for key in ("mean", "scale", "weight"))
        return cls(names, mean, scale, weight, float(document["bias"]))

    def document(self) -> dict[str, Any]:
        """The model as plain values for JSON."""
        return {
            "features": list(self.names),
            "mean": self.mean.tolist(),
            "scale": self.scale.tolist(),
            "weight": self.weight.tolist(),
            "bias": self.bias,
        }

    def probability(self, features: FloatArray) -> FloatArray:
        """(N,) in (0, 1) for features (N, M)."""
        probability = np.empty(len(features))
        write_probabilities(np.ascontiguousarray(features.T), self.arrays(), probability)
        return probability

    def arrays(self) -> "LogisticArrays":
        """The numbers of the model for compiled code."""
        return LogisticArrays(self.mean, self.scale, self.weight.reshape(4, -1), self.bias)


class LogisticArrays(NamedTuple):
    """The numbers of a :class:`LogisticModel`."""

    mean: FloatArray  # (M,)
    scale: FloatArray  # (M,)
    weight: FloatArray  # (4, M)
    bias: float


def basis(standardised: FloatArray) -> FloatArray:
    """(N, 4 M) z, z^2, max(0, z - 1) and max(0, -z - 1) of features (N, M) in standard deviations, z clipped at +-4."""
    z = np.clip(standardised, -CLIP, CLIP)
    return np.concatenate([z, z * z, np.maximum(z - _HINGE, 0.0), np.maximum(-z - _HINGE, 0.0)], axis=1)


@kernel
def write_probabilities(columns, model, probability):  # type: ignore[no-untyped-def]
    """The logistic function of bias + weight . basis, without an array of the basis, for columns (M, N) of features.

    The loops over the rows are innermost, for vector instructions.
    """
    probability[:] = model.bias
    for j in range(len(columns)):
        mean, scale = model.mean[j], model.scale[j]
        a, b, c, d = model.weight[0, j], model.weight[1, j], model.weight[2, j], model.weight[3, j]
        for i in range(len(probability)):
            z = min(max((columns[j, i] - mean) / scale, -CLIP), CLIP)
            score = probability[i] + (a * z + b * z * z)
            probability[i] = score + (c * max(z - _HINGE, 0.0) + d * max(-z - _HINGE, 0.0))
    for i in range(len(probability)):
        probability[i] = 1.0 / (1.0 + np.exp(-probability[i]))
