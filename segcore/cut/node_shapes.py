"""The shapes of sets of nodes, of those of a tree of cuts as well, and the borders that its cuts make."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.graphs.tree import Tree


@dataclass(frozen=True, slots=True, eq=False)
class Shapes:
    """What does not change if a part is moved, turned or mirrored."""

    log_area: FloatArray  # (K,)
    spread: FloatArray  # (K, 3) standard deviations along the principal axes, ascending

    @classmethod
    def of(cls, sums: FloatArray, node_variance: float = 0.0) -> "Shapes":
        """The shapes of sets of nodes with given ``moment_sums`` (K, 10).

        Parameters
        ----------
        node_variance : of the area of a node, along an axis.
        """
        moments = sums[:, 1:] / sums[:, :1]
        mean = moments[:, :3]
        second = moments[:, [3, 4, 5, 4, 6, 7, 5, 7, 8]].reshape(-1, 3, 3)
        variance = np.linalg.eigvalsh(second - mean[:, :, None] * mean[:, None, :]) + node_variance
        return cls(np.log(sums[:, 0]), np.sqrt(np.maximum(variance, 0.0)))

    def like(self, log_area: float, spread: FloatArray, of_area: float, of_spread: float) -> BoolArray:
        """(K,) True for the shapes that are about the same as one with an area and a spread (3,).

        Parameters
        ----------
        of_area : largest difference of the logarithms of the areas.
        of_spread : largest difference of the standard deviations, in the largest one of ``spread``.
        """
        is_like: BoolArray = np.abs(self.log_area - log_area) <= of_area
        is_like &= np.all(np.abs(self.spread - spread) <= of_spread * spread[2], axis=1)
        return is_like


@dataclass(frozen=True, slots=True, eq=False)
class TreeCuts:
    """The cuts of the splits of a tree."""

    length: FloatArray  # (S,) 0 between components that lie apart
    weight: FloatArray  # (S,)

    @property
    def log_length(self) -> FloatArray:
        """(S,) logarithms; those between components that lie apart are all equal."""
        return np.log(np.maximum(self.length, np.finfo(float).tiny))


def moment_sums(group: IntArray, volume: FloatArray, points: FloatArray, count: int) -> FloatArray:
    """(count, 10) the volume of every group of nodes, and the sums over it of their coordinates and of the products.

    Parameters
    ----------
    group, volume, points : (N,), (N,), (N, 3) of the nodes.
    """
    x, y, z = points.T
    columns = [np.ones(len(points)), x, y, z, x * x, x * y, x * z, y * y, y * z, z * z]
    return np.stack([group_sums(group, volume * column, count) for column in columns], axis=1)


def shapes_of(graph: SurfaceGraph, points: FloatArray, tree: Tree) -> Shapes:
    """The shapes of the 2 S + 1 nodes of a tree.

    Parameters
    ----------
    points : (N, 3) positions of the nodes of the graph.
    """
    sums = moment_sums(tree.leaf, graph.volume, points, 2 * len(tree.split_node) + 1)
    for split in reversed(range(len(tree.split_node))):
        sums[tree.split_node[split]] = sums[2 * split + 1] + sums[2 * split + 2]
    return Shapes.of(sums, _node_variance(graph, points))


def cuts_of(graph: SurfaceGraph, tree: Tree) -> TreeCuts:
    """The length and the weight of the cut of every split."""
    splits = len(tree.split_node)
    split = tree.split_between(*tree.leaf[graph.edges].T)
    crossing = split >= 0
    return TreeCuts(
        length=group_sums(split[crossing], graph.length[crossing], splits),
        weight=group_sums(split[crossing], graph.weight[crossing], splits),
    )


def _node_variance(graph: SurfaceGraph, points: FloatArray) -> float:
    """The variance within a node of the graph along an axis: that of an interval as long as neighbours are apart."""
    if len(graph.edges) == 0:
        return 0.0
    between = points[graph.edges[:, 0]] - points[graph.edges[:, 1]]
    return float(np.median(np.einsum("ij,ij->i", between, between))) / 12.0
