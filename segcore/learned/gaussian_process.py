"""Gaussian process regression around a logistic trend."""

from base64 import b64decode, b64encode
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from segcore.arrays import FloatArray
from segcore.jit.decorators import kernel
from segcore.learned.logistic import CLIP, LogisticModel

_STEP = CLIP / 127.0  # of the stored centres, in standard deviations


@dataclass(frozen=True, slots=True, eq=False)
class GaussianProcess:
    """p = trend + sum over C centres of weight exp(-d^2 / 2), within 0..1; d is the distance from the centre.

    Features count in standard deviations, clipped at +-4, over the length scale. Far from all centres, that is for rows
    unlike those that were learned from, p is the trend.

    References
    ----------
    Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, section 8.3.1 (subset of regressors).
    """

    names: tuple[str, ...]  # of the M features; the trend has some of them
    mean: FloatArray  # (M,)
    scale: FloatArray  # (M,) > 0, standard deviations
    length: float  # length scale > 0, in standard deviations
    centres: npt.NDArray[np.int8]  # (C, M) in 127ths of four standard deviations
    weight: FloatArray  # (C,)
    trend: LogisticModel

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> "GaussianProcess":
        """The inverse of ``document``."""
        names = tuple(document["features"])
        mean, scale, weight = (np.array(document[key], dtype=np.float64) for key in ("mean", "scale", "weight"))
        centres = np.frombuffer(b64decode(document["centres"]), dtype=np.int8).reshape(len(weight), len(names))
        trend = LogisticModel.from_document(document["trend"])
        return cls(names, mean, scale, float(document["length"]), centres, weight, trend)

    def document(self) -> dict[str, Any]:
        """The model as plain values for JSON, the centres as Base64 of their bytes."""
        return {
            "features": list(self.names),
            "mean": self.mean.tolist(),
            "scale": self.scale.tolist(),
            "length": self.length,
            "centres": b64encode(self.centres.tobytes()).decode("ascii"),
            "weight": self.weight.tolist(),
            "trend": self.trend.document(),
        }

    def estimate(self, features: FloatArray) -> FloatArray:
        """(N,) in 0..1 for features (N, M)."""
        columns = [self.names.index(name) for name in self.trend.names]
        trend = self.trend.probability(np.ascontiguousarray(features[:, columns]))
        correction = similarities(self.scaled(features), self.scaled_centres()) * self.weight
        # The sum does not depend on the number of threads, as a product of matrices would.
        return np.clip(trend + correction.sum(axis=1), 0.0, 1.0)

    def scaled(self, features: FloatArray) -> FloatArray:
        """(N, M) features over the length scale, in one order in memory, so that the kernel is compiled once."""
        return np.ascontiguousarray(np.clip((features - self.mean) / self.scale, -CLIP, CLIP) / self.length)

    def scaled_centres(self) -> FloatArray:
        """(C, M) the centres over the length scale."""
        return self.centres.astype(np.float64) * (_STEP / self.length)


def quantised(standardised: FloatArray) -> npt.NDArray[np.int8]:
    """(N, M) features in standard deviations as centres are stored."""
    return np.rint(np.clip(standardised, -CLIP, CLIP) / _STEP).astype(np.int8)


@kernel
def similarities(one: FloatArray, other: FloatArray) -> FloatArray:
    """(N, C) exp(-d^2 / 2) with the distances d of rows (N, M) and (C, M)."""
    similarity = np.empty((len(one), len(other)))
    for i in range(len(one)):
        for c in range(len(other)):
            square = 0.0
            for j in range(one.shape[1]):
                difference = one[i, j] - other[c, j]
                square += difference * difference
            similarity[i, c] = np.exp(-0.5 * square)
    return similarity
