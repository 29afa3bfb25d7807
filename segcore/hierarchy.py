"""The binary tree of cuts: labels at any number of segments without recomputation."""

from dataclasses import dataclass, field

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.errors import InvalidParameters
from segcore.nary import nary_children, own_steps


def renumbered_nodes(order: IntArray) -> IntArray:
    """(2 S + 1,) the new number of every node of a hierarchy if its splits are made in another order.

    Parameters
    ----------
    order : (S,) the splits from first to last, parents before children.
    """
    number = np.zeros(2 * len(order) + 1, dtype=np.int32)
    place = np.arange(len(order), dtype=np.int32)
    number[2 * order + 1] = 2 * place + 1
    number[2 * order + 2] = 2 * place + 2
    return number


@dataclass(frozen=True, slots=True, eq=False)
class Hierarchy:
    """The splits of a mesh in the order in which they were made.

    Node 0 is the whole mesh. Split s (0, 1, ...) cuts node ``split_node[s]`` in two: the larger part becomes node
    2 s + 1 and the smaller one node 2 s + 2. After splits 0..s there are s + 2 segments. The node numbers therefore
    determine the order of the splits, the parents and the level at which a node appears.

    The splits that cut off equal parts belong to one step. Steps have the numbers 0, 1, ... in the order of their first
    splits. ``max_segments`` is the number at which the hierarchy ends: because no sensible cut is left, or because of
    the limit that was set (``limit_reached``).
    """

    split_node: IntArray  # (S,) the node that split s cuts, split_node[s] <= 2 s
    cut_value: FloatArray  # (S,) normalized cut times sqrt(total area), dimensionless; 0 between components
    area: FloatArray  # (2 S + 1,) surface area of every node, in squared units of the mesh
    face_count: IntArray  # (2 S + 1,) input faces of every node
    face_leaf: IntArray  # (F,) the leaf node of every input face
    automatic_segments: int  # the number of segments chosen when none is given
    step: IntArray = field(default_factory=lambda: own_steps(0))  # (S,) the step 0, 1, ... of each split; see ``nary``
    limit_reached: bool | None = None  # whether a limit of the number left sensible cuts out; None: not known

    def __post_init__(self) -> None:
        """If no steps are given, every split is a step."""
        if len(self.step) == 0:
            object.__setattr__(self, "step", own_steps(len(self.split_node)))

    @property
    def max_segments(self) -> int:
        """The number of segments after all splits."""
        return len(self.split_node) + 1

    @property
    def node_count(self) -> int:
        """N, the number of nodes: 2 S + 1."""
        return 2 * len(self.split_node) + 1

    @property
    def children(self) -> IntArray:
        """(N, 2) the two children of every node, the larger one first; -1 for leaves."""
        children = np.full((self.node_count, 2), -1, dtype=np.int32)
        children[self.split_node] = 1 + np.arange(2 * len(self.split_node), dtype=np.int32).reshape(-1, 2)
        return children

    @property
    def nary_children(self) -> list[list[int]]:
        """The children of every node in the tree of steps, see :func:`segcore.nary.nary_children`."""
        return nary_children(self.split_node, self.step)

    @property
    def step_ends(self) -> IntArray:
        """(T + 1,) the numbers of segments that are worth offering: 1, and those after the last split of each step.

        In between, some of a set of equal parts are cut off and others are not.
        """
        last = np.zeros(int(self.step.max(initial=-1)) + 1, dtype=np.int32)
        np.maximum.at(last, self.step, np.arange(2, self.max_segments + 1, dtype=np.int32))
        return np.concatenate([np.array([1], dtype=np.int32), np.sort(last)])

    @property
    def parent(self) -> IntArray:
        """(N,) the parent of every node; -1 for the root."""
        return np.concatenate([np.array([-1], dtype=np.int32), np.repeat(self.split_node, 2)])

    @property
    def level(self) -> IntArray:
        """(N,) the smallest number of segments at which a node is a segment."""
        return np.concatenate(
            [np.array([1], dtype=np.int32), np.repeat(np.arange(len(self.split_node), dtype=np.int32) + 2, 2)]
        )

    @property
    def label(self) -> IntArray:
        """(N,) the label of a node at all levels at which it is a segment.

        The larger part of a cut keeps its parent's label and the smaller one gets the next new label. A segment that is
        not split therefore keeps its label, and its colour, at every level.
        """
        label = np.zeros(self.node_count, dtype=np.int32)
        for split, node in enumerate(self.split_node.tolist()):
            label[2 * split + 1] = label[node]
            label[2 * split + 2] = split + 1
        return label

    def segment_nodes(self, segments: int | None = None) -> IntArray:
        """(K,) the nodes of the segments 0, 1, ..., K - 1.

        Parameters
        ----------
        segments : the number of segments K, by default ``automatic_segments``.

        Raises
        ------
        InvalidParameters
            If ``segments`` is not in 1..max_segments.
        """
        count = self._checked(segments)
        nodes = np.zeros(count, dtype=np.int32)
        label = self.label
        for split in range(count - 1):
            nodes[label[2 * split + 1]] = 2 * split + 1
            nodes[split + 1] = 2 * split + 2
        return nodes

    def segments_at(self, granularity: float) -> int:
        """The number of segments K at a granularity: 1 at 0, ``automatic_segments`` at 0.5, ``max_segments`` at 1.

        In between, equal steps of the granularity multiply K by equal factors.

        Raises
        ------
        InvalidParameters
            If the granularity is not in 0..1.
        """
        if not 0.0 <= granularity <= 1.0:
            raise InvalidParameters(f"The granularity must be a number from 0 (coarse) to 1 (fine), not {granularity}.")
        if granularity <= 0.5:
            return round(self.automatic_segments ** (2.0 * granularity))
        finer = self.max_segments / self.automatic_segments
        return round(self.automatic_segments * finer ** (2.0 * granularity - 1.0))

    def labels(self, segments: int | None = None) -> IntArray:
        """(F,) int32 labels of the input faces in input order: all of 0..K - 1 occur.

        Parameters
        ----------
        segments : the number of segments K, by default ``automatic_segments``.

        Raises
        ------
        InvalidParameters
            If ``segments`` is not in 1..max_segments.
        """
        count = self._checked(segments)
        label_of_node = np.zeros(self.node_count, dtype=np.int32)
        for split, node in enumerate(self.split_node.tolist()):
            label_of_node[2 * split + 1] = label_of_node[node]
            label_of_node[2 * split + 2] = split + 1 if split < count - 1 else label_of_node[node]
        labels: IntArray = label_of_node[self.face_leaf]
        return labels

    def _checked(self, segments: int | None) -> int:
        count = self.automatic_segments if segments is None else segments
        if not 1 <= count <= self.max_segments:
            reason = "" if self.limit_reached is not False else " No sensible cut is left beyond that."
            raise InvalidParameters(
                f"The number of segments must be from 1 to {self.max_segments} for this mesh, not {count}.{reason}"
            )
        return count
