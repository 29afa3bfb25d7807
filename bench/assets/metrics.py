"""Agreement of segments with authored parts, weighted by the area of the faces that belong to a part.

Everything is computed from the table n of shared areas: n[i, j] is the area that segment i and part j share. Shares of
pairs of points, not of faces, therefore do not depend on how finely a shape is meshed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import linear_sum_assignment

from bench.assets.dataset import NO_PART

if TYPE_CHECKING:
    from segcore.arrays import FloatArray, IntArray, LongArray
    from segcore.hierarchy import Hierarchy


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """The authored parts of a mesh, with the areas of its faces."""

    part: LongArray  # (F,) part 0, 1, ..., K - 1 of every face, NO_PART if it belongs to none
    area: FloatArray  # (F,) area of every face

    @property
    def parts(self) -> int:
        """K, the number of parts."""
        return int(self.part.max(initial=NO_PART)) + 1

    def shared_areas(self, label: IntArray | LongArray) -> FloatArray:
        """(S, K) area that segment i = 0, 1, ..., S - 1 and part j share; faces without a part are left out.

        Parameters
        ----------
        label : (F,) segment of every face, >= 0.
        """
        counted = self.part != NO_PART
        segments = int(label.max()) + 1
        cell = label[counted].astype(np.int64) * self.parts + self.part[counted]
        area = np.bincount(cell, self.area[counted], minlength=segments * self.parts).astype(np.float64)
        return area.reshape(segments, self.parts)


def one_minus_rand(shared: FloatArray) -> float:
    """Share of the pairs of points that one segmentation joins and the other separates.

    1 - Rand = (sum_i a_i^2 + sum_j b_j^2 - 2 sum_ij n_ij^2) / A^2, with a and b the sums of the rows and columns of n
    and A the sum of n; 0 if A is 0.
    """
    return _disagreement(_squares(shared.sum(axis=1)), _squares(shared), shared)


def mean_iou(shared: FloatArray) -> float:
    """Mean over the parts of the intersection over union with the segment that is matched to the part.

    The matching is the one to one assignment with the largest sum (Kuhn, The Hungarian method, 1955). A part without a
    segment counts as 0, and so does a part without area; segments without a part do not count.
    """
    union = shared.sum(axis=1, keepdims=True) + shared.sum(axis=0) - shared
    iou = np.divide(shared, union, out=np.zeros(shared.shape), where=union > 0)
    segment, part = linear_sum_assignment(iou, maximize=True)
    return float(iou[segment, part].sum() / shared.shape[1])


def rand_of_levels(hierarchy: Hierarchy, reference: Reference) -> FloatArray:
    """(max_segments,) 1 - Rand of the levels 1, 2, ..., max_segments of a hierarchy. O(F + max_segments K).

    A split changes the sums of squares of ``one_minus_rand`` by the rows of one node and its two children only.
    """
    nodes = hierarchy.node_count
    shared = np.zeros((nodes, reference.parts))
    leaves = reference.shared_areas(hierarchy.face_leaf)
    shared[: len(leaves)] = leaves
    for split in reversed(range(len(hierarchy.split_node))):
        shared[hierarchy.split_node[split]] += shared[2 * split + 1] + shared[2 * split + 2]
    of_node = np.stack([shared.sum(axis=1) ** 2, (shared**2).sum(axis=1)], axis=1)
    gain = of_node[1::2] + of_node[2::2] - of_node[hierarchy.split_node]
    sums = np.cumsum(np.concatenate([of_node[:1], gain]), axis=0)
    return np.array([_disagreement(rows, cells, shared[:1]) for rows, cells in sums.tolist()])


def _disagreement(rows: float, cells: float, shared: FloatArray) -> float:
    total = float(shared.sum())
    return (rows + _squares(shared.sum(axis=0)) - 2 * cells) / total**2 if total > 0 else 0.0


def _squares(values: FloatArray) -> float:
    return float((values * values).sum())
