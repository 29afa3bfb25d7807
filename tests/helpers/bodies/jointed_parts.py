"""Parts that are grids of nodes in space, with joints between them, and trees that separate them."""

from dataclasses import dataclass

import numpy as np

from segcore.graphs.surface_graph import SurfaceGraph
from segcore.graphs.tree import Tree

BODY, LEG, LONG_LEG, FLAT = (8, 8), (2, 6), (2, 9), (3, 4)  # rows and columns of nodes; FLAT has the size of LEG


@dataclass(frozen=True, slots=True, eq=False)
class Parts:
    """Grids of nodes in space, far apart from one another, with joints between them."""

    sizes: list[tuple[int, int]]
    joints: list[tuple[int, int]]
    affinity: float = 0.1  # of the joints
    widths: dict[int, int] | None = None  # edges of a joint, 2 by default

    def graph(self) -> tuple[SurfaceGraph, np.ndarray, np.ndarray]:
        """The graph, the positions of its nodes and the part of each node."""
        first = np.cumsum([0, *(rows * columns for rows, columns in self.sizes)])
        part = np.repeat(np.arange(len(self.sizes)), np.diff(first))
        grids = [np.indices(size).reshape(2, -1).T for size in self.sizes]
        points = np.concatenate(
            [np.pad(grid, ((0, 0), (0, 1)), constant_values=20.0 * i) for i, grid in enumerate(grids)]
        )
        edges, affinity = [], []
        for at, (rows, columns) in zip(first, self.sizes, strict=False):
            grid = at + np.arange(rows * columns).reshape(rows, columns)
            inner = [*zip(grid[:-1].flat, grid[1:].flat, strict=True)]
            inner += [*zip(grid[:, :-1].flat, grid[:, 1:].flat, strict=True)]
            edges += inner
            affinity += [1.0] * len(inner)
        for joint, (a, b) in enumerate(self.joints):
            width = (self.widths or {}).get(joint, 2)
            edges += [(first[a] + i, first[b] + i) for i in range(width)]
            affinity += [self.affinity] * width
        length = np.ones(len(edges))
        graph = SurfaceGraph(np.array(edges, np.int32), np.array(affinity), np.ones(len(part)), length)
        return graph, points.astype(np.float64), part

    def tree(self, cuts: list[tuple[set[int], set[int]]]) -> Tree:
        """The tree whose split s separates two sets of parts, the larger one first."""
        part = self.graph()[2]
        nodes: list[frozenset[int]] = [frozenset(range(len(self.sizes)))]
        split_node = []
        for larger, smaller in cuts:
            split_node.append(nodes.index(frozenset(larger | smaller)))
            nodes += [frozenset(larger), frozenset(smaller)]
        leaf = np.array([nodes.index(frozenset([p])) for p in part], np.int32)
        return Tree(np.array(split_node, np.int32), np.ones(len(cuts)), leaf, 1)


def star(legs: list[tuple[int, int]], **options: object) -> Parts:
    """A body, part 0, with legs 1, 2, ... at it."""
    return Parts([BODY, *legs], [(0, leg + 1) for leg in range(len(legs))], **options)


def one_by_one(legs: list[int]) -> list[tuple[set[int], set[int]]]:
    """The legs are cut off the body in this order."""
    return [({0, *legs[i + 1 :]}, {leg}) for i, leg in enumerate(legs)]
