"""Means of regression trees that were grown at random."""

from base64 import b64decode, b64encode
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from segcore.arrays import FloatArray
from segcore.jit.decorators import kernel

LEAF = -1  # in place of a feature
# A node is followed by its first child, to which rows of at most ``number`` of the feature go.
NODE = np.dtype([("feature", "<i2"), ("second", "<u2"), ("number", "<f4")])


@dataclass(frozen=True, slots=True, eq=False)
class Forest:
    """The mean of T regression trees.

    References
    ----------
    Geurts, Ernst and Wehenkel, Extremely randomized trees, Machine Learning 63, 2006.
    """

    names: tuple[str, ...]  # of the M features
    nodes: npt.NDArray[np.void]  # (T, N) of NODE, each tree in preorder; ``number`` of a leaf is its value

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> "Forest":
        """The inverse of ``document``."""
        nodes = np.frombuffer(b64decode(document["nodes"]), dtype=NODE)
        return cls(tuple(document["features"]), nodes.reshape(document["trees"], -1))

    def document(self) -> dict[str, Any]:
        """The forest as plain values for JSON, the nodes as Base64 of their bytes."""
        return {
            "features": list(self.names),
            "trees": len(self.nodes),
            "nodes": b64encode(self.nodes.tobytes()).decode("ascii"),
        }

    def mean(self, features: FloatArray) -> FloatArray:
        """(N,) mean of the trees for features (N, M)."""
        nodes = self.nodes
        features = np.ascontiguousarray(features)  # in one order, so that the kernel is compiled once
        return _means(features, *(np.ascontiguousarray(nodes[name]) for name in ("feature", "second", "number")))


@kernel
def _means(features, feature, second, number):  # type: ignore[no-untyped-def]
    trees = len(feature)
    mean = np.zeros(len(features))
    for i in range(len(features)):
        for t in range(trees):
            node = 0
            while feature[t, node] >= 0:
                node = node + 1 if features[i, feature[t, node]] <= number[t, node] else second[t, node]
            mean[i] += number[t, node]
        mean[i] /= trees
    return mean
