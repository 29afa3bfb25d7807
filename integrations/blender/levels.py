"""The hierarchy of parts of a mesh: labels at any number of segments without computing again."""

import io
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .arrays import IntArray
from .errors import CleaveError


@dataclass(frozen=True, slots=True, eq=False)
class Levels:
    """The splits of a mesh in their order: split s cuts a node into the nodes 2 s + 1 and 2 s + 2; node 0 is all."""

    split_node: list[int]  # (S,) the node that split s cuts
    leaf: IntArray  # (F,) the leaf that each face is in
    automatic: int  # the recommended number of segments

    @property
    def most(self) -> int:
        """The largest number of segments."""
        return len(self.split_node) + 1

    def labels(self, segments: int) -> IntArray:
        """(F,) the labels 0..segments - 1 of the faces; ``segments`` is from 1 to ``most``."""
        label_of_node = np.zeros(2 * self.most - 1, dtype=np.int32)
        for split, node in enumerate(self.split_node):
            label_of_node[2 * split + 1] = label_of_node[node]
            label_of_node[2 * split + 2] = split + 1 if split < segments - 1 else label_of_node[node]
        labels: IntArray = label_of_node[self.leaf]
        return labels

    def segments_at(self, granularity: float) -> int:
        """The number of segments at a granularity: 1 at 0, ``automatic`` at 0.5, ``most`` at 1, by equal factors."""
        if granularity <= 0.5:
            return round(math.pow(self.automatic, 2.0 * granularity))
        return round(self.automatic * math.pow(self.most / self.automatic, 2.0 * granularity - 1.0))


def levels_from(document: Mapping[str, Any], finest: bytes, faces: int) -> Levels:
    """Return the levels of a mesh.

    Parameters
    ----------
    document : the hierarchy as Cleave writes it in JSON.
    finest : the labels at the largest number of segments, a ``.npy`` file.
    faces : the number of faces of the mesh.

    Raises
    ------
    CleaveError
        If these are not the results of such a mesh.
    """
    try:
        labels = np.load(io.BytesIO(finest), allow_pickle=False)
        nodes = sorted(document["nodes"], key=lambda node: int(node["id"]))
        node_of_label = {int(node["label"]): int(node["id"]) for node in nodes if not node["children"]}
        leaf_of_label = np.array([node_of_label[label] for label in range(len(node_of_label))], dtype=np.int32)
        split_node = [int(node["parent"]) for node in nodes[1::2]]
        levels = Levels(split_node, leaf_of_label[labels], int(document["automatic_segments"]))
    except (ValueError, KeyError, IndexError, TypeError) as error:
        raise CleaveError("Cleave's answer cannot be read: update the extension, or the server.") from error
    if levels.leaf.shape != (faces,):
        raise CleaveError(f"Cleave's answer has {levels.leaf.size} faces, but the mesh has {faces}: run it again.")
    return levels
