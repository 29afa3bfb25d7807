"""Logistic regression on standardised features, their squares and hinges."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit

from segcore.arrays import FloatArray

_CLIP = 4.0  # standard deviations at which features are clipped: a limit on extrapolation, set by hand
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
        return _probabilities(features, self.mean, self.scale, self.weight.reshape(4, -1), self.bias)


def basis(standardised: FloatArray) -> FloatArray:
    """(N, 4 M) z, z^2, max(0, z - 1) and max(0, -z - 1) of features (N, M) in standard deviations, z clipped at +-4."""
    z = np.clip(standardised, -_CLIP, _CLIP)
    return np.concatenate([z, z * z, np.maximum(z - _HINGE, 0.0), np.maximum(-z - _HINGE, 0.0)], axis=1)


@njit(cache=True)
def _probabilities(features, mean, scale, weight, bias):  # type: ignore[no-untyped-def]
    """The logistic function of bias + weight . basis, without an array of the basis. Weights are (4, M)."""
    probability = np.empty(len(features))
    for i in range(len(features)):
        score = bias
        for j in range(len(mean)):
            z = min(max((features[i, j] - mean[j]) / scale[j], -_CLIP), _CLIP)
            score += weight[0, j] * z + weight[1, j] * z * z
            score += weight[2, j] * max(z - _HINGE, 0.0) + weight[3, j] * max(-z - _HINGE, 0.0)
        probability[i] = 1.0 / (1.0 + np.exp(-score))
    return probability


def signed_log(x: FloatArray) -> FloatArray:
    """sign(x) log(1 + |x|): linear near 0, logarithmic in the tails."""
    squeezed: FloatArray = np.sign(x) * np.log1p(np.abs(x))
    return squeezed
