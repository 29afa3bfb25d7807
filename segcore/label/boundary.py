"""The last touch: every boundary becomes a minimum cut of the mesh itself within a narrow band around it.

A cut of clusters follows their jagged outlines. Within the band the cheapest cut runs along concavities where there are
any and is short elsewhere. Split by split, from the first one on, faces near a boundary may change sides; what lies
farther away does not, so that every part keeps its core. Only the faces of the bands are visited.
"""

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.clean.edge_geometry import edge_lengths
from segcore.clean.surface import Surface
from segcore.coarsen.assembly import CONTACT
from segcore.coarsen.contacts import Links
from segcore.graphs.max_flow import push
from segcore.graphs.mesh_graph import MeshGraph
from segcore.graphs.surface_graph import SurfaceGraph, rows_of
from segcore.graphs.tree import Tree, intervals
from segcore.label.band import band_network, free_faces, grow_band
from segcore.label.leaves import broken_leaves, changed_places, crossing_edges, edges_around, move

BAND = 0.03  # of sqrt(total area), to either side of a boundary
STIFFNESS = 0.1  # added to the affinity in the cost of a boundary: makes it shorter where concavities say little
_MOST_FACES = 16384  # in one band: of very fine meshes it is narrower, because flows take longer on wide ones
_ATTEMPTS = 3  # at a cut that leaves all parts of the hierarchy in one piece


def draw_boundaries(tree: Tree, nodes: MeshGraph, links: Links, surface: Surface) -> Tree:
    """Move the boundaries of a tree over the faces of a surface to minimum cuts nearby.

    The cost of a boundary is its length times (g + 0.1). Every node of the tree that was connected stays connected, and
    every leaf keeps half of its faces.

    Parameters
    ----------
    nodes : the face dual graph of the surface.
    links : between its components.
    """
    if len(tree.split_node) == 0:
        return tree
    cost = nodes.graph.weight + STIFFNESS * edge_lengths(surface)
    linked = SurfaceGraph(
        np.concatenate([surface.edge_faces, links.faces]),
        np.concatenate([cost, CONTACT * links.length]),
        nodes.graph.volume,
    )
    drawing = _Drawing(tree, linked, surface, nodes.points)
    for split in range(len(tree.split_node)):
        drawing.redraw(split)
    return drawing.finished()


class _Drawing:
    """The places of all faces: leaves numbered so that every node has consecutive ones; and what depends on them."""

    def __init__(self, tree: Tree, graph: SurfaceGraph, surface: Surface, centres: FloatArray) -> None:
        splits = len(tree.split_node)
        self._tree = tree
        self._graph = graph
        self._geometry = (surface.edge_vertices, surface.vertices, centres)
        self._width = BAND * float(np.sqrt(graph.total_volume))
        rows = rows_of(graph.edges, graph.node_count)
        self._rows = (rows.start, rows.neighbour, rows.edge)
        self._place_of_node, self._first, self._end = intervals(tree)
        self._place = self._place_of_node[tree.leaf]
        self._split_at = np.zeros(splits + 1, dtype=np.int32)  # the split that parts the leaves at places i - 1 and i
        self._split_at[self._first[2::2]] = np.arange(splits)
        self._size = np.bincount(self._place, minlength=splits + 1)
        self._least = (self._size + 1) // 2
        crossing, split = crossing_edges(graph.edges, self._place, self._split_at)
        self._crossings = np.bincount(split, minlength=splits)
        by_split = np.split(crossing[np.argsort(split, kind="stable")], np.cumsum(self._crossings)[:-1])
        self._edges = [[edges] for edges in by_split]  # of every split, those that crossed it at some time
        self._local = np.full(graph.node_count, -1, dtype=np.int32)
        self._entry = np.full(len(graph.edges), -1, dtype=np.int32)
        self._visited = np.zeros(graph.node_count, dtype=bool)

    def redraw(self, split: int) -> None:
        """Move the boundary of a split, unless every attempt breaks a part."""
        bounds = (
            int(self._first[2 * split + 1]),
            int(self._first[2 * split + 2]),
            int(self._end[2 * split + 2]),
        )
        edges = np.concatenate(self._edges[split])
        faces, distance = grow_band(
            edges, self._graph.edges, self._place, bounds, self._rows, *self._geometry, self._width, self._local
        )
        if len(faces) > _MOST_FACES:
            near = distance < np.partition(distance, _MOST_FACES)[_MOST_FACES]
            faces, distance = faces[near], distance[near]
        pinned = np.zeros(len(self._size), dtype=bool)
        for _ in range(_ATTEMPTS):
            free = free_faces(faces, distance, self._place, self._size, pinned)
            broken = self._cut(free, bounds)
            if not broken.any():
                return
            pinned |= broken

    def _cut(self, free: IntArray, bounds: tuple[int, int, int]) -> BoolArray:
        """Make the least cut of the free faces the boundary; where it breaks leaves, say which, and change nothing."""
        start, neighbour, reverse, capacity, excess = band_network(
            free, self._place, bounds, self._rows, self._graph.weight, self._local, self._entry
        )
        if not (excess.max(initial=0.0) > 0.0 > excess.min(initial=0.0)):
            return np.zeros(len(self._size), dtype=bool)
        lower = push(start, neighbour, reverse, capacity, excess) == len(free)
        faces, places = changed_places(free, lower, self._place, bounds, self._rows, self._graph.weight, self._local)
        before = self._place[faces]
        whole = self._crossings > 0
        self._move(faces, places)
        broken = broken_leaves(faces, before, self._place, self._size, self._least, self._rows, self._visited)
        if not broken.any() and (whole & (self._crossings == 0)).any():
            broken[before] = True
        if broken.any():
            self._move(faces[::-1], before[::-1])
        else:
            self._remember(edges_around(faces, self._rows))
        return broken

    def _move(self, faces: IntArray, places: IntArray) -> None:
        move(faces, places, self._place, self._size, self._crossings, self._split_at, self._rows)

    def _remember(self, edges: IntArray) -> None:
        """Enter edges with the splits that they cross now."""
        edges = np.unique(edges)
        crossing, split = crossing_edges(self._graph.edges[edges], self._place, self._split_at)
        for crossed in np.unique(split).tolist():
            self._edges[crossed].append(edges[crossing[split == crossed]])

    def finished(self) -> Tree:
        """The tree over the faces, of the two parts of every split the larger one first again."""
        tree = self._tree
        leaf_at = np.empty(len(self._size), dtype=np.int32)
        leaves = np.setdiff1d(np.arange(len(self._place_of_node), dtype=np.int32), tree.split_node)
        leaf_at[self._place_of_node[leaves]] = leaves
        leaf = leaf_at[self._place]
        volume = group_sums(leaf, self._graph.volume, len(self._place_of_node))
        number = np.arange(len(volume), dtype=np.int32)
        for split in reversed(range(len(tree.split_node))):
            volume[tree.split_node[split]] = volume[2 * split + 1] + volume[2 * split + 2]
            if volume[2 * split + 1] < volume[2 * split + 2]:
                number[[2 * split + 1, 2 * split + 2]] = 2 * split + 2, 2 * split + 1
        return Tree(number[tree.split_node], tree.cut_value, number[leaf], tree.automatic_segments)
