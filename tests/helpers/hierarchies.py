"""Hierarchies with known leaves, and segmenters that return them.

The segmenters are in a module, not in a test, because other processes import them.
"""

from contextvars import Context
from dataclasses import dataclass

import numpy as np

from bench.segmenter import CleaveSegmenter
from segcore.arrays import IntArray
from segcore.hierarchy import Hierarchy
from segcore.learned.models import learned_models
from segcore.mesh import Mesh


def hierarchy_of(split_node: list[int], face_leaf: IntArray, automatic: int) -> Hierarchy:
    """A hierarchy with these splits and leaves; cut values, areas and counts are 0."""
    nodes = 2 * len(split_node) + 1
    splits = np.array(split_node, dtype=np.int32)
    zeros = np.zeros(nodes, dtype=np.int32)
    return Hierarchy(splits, np.zeros(len(splits)), np.zeros(nodes), zeros, face_leaf.astype(np.int32), automatic)


def hierarchy_of_labels(labels: IntArray) -> Hierarchy:
    """A hierarchy whose automatic level has these labels 0..K - 1: it cuts off label 1, then label 2, and so on."""
    count = int(labels.max()) + 1
    splits = [0, *range(1, 2 * count - 3, 2)] if count > 1 else []
    return hierarchy_of(splits, np.where(labels > 0, 2 * labels, max(2 * count - 3, 0)), count)


@dataclass(frozen=True, slots=True)
class HeightSegmenter(CleaveSegmenter):
    """Cuts a mesh into three layers of equal height: the top off the rest, then the middle off the bottom.

    The automatic number is 2.
    """

    def warm_up(self) -> None:
        """Do nothing."""

    def __call__(self, mesh: Mesh, seed: int) -> Hierarchy:  # noqa: ARG002
        return layers(mesh, 2)


@dataclass(frozen=True, slots=True)
class ModelSegmenter(CleaveSegmenter):
    """The same with the automatic number 3 if other learned models are in use than those that ship."""

    def warm_up(self) -> None:
        """Do nothing."""

    def __call__(self, mesh: Mesh, seed: int) -> Hierarchy:  # noqa: ARG002
        return layers(mesh, 2 if learned_models() is Context().run(learned_models) else 3)


def layers(mesh: Mesh, automatic: int) -> Hierarchy:
    """The hierarchy of three layers along the z axis, 3 at the bottom, 4 in the middle and 2 at the top."""
    height = mesh.corners[:, :, 2].mean(axis=1)
    low, high = mesh.vertices[:, 2].min(), mesh.vertices[:, 2].max()
    layer = np.floor(3 * (height - low) / (high - low)).astype(int)
    return hierarchy_of([0, 1], np.array([3, 4, 2])[layer.clip(0, 2)], automatic)
