"""Boundaries of the parts as minimum cuts of the mesh, each within a narrow band around a cut of clusters.

A cut of clusters follows their jagged outlines. Within the band the cheapest cut runs along concavities if there are
any and is short otherwise. Split by split, in the order of the tree, faces near a boundary may change sides. Faces
farther away keep theirs, so that every part keeps its core. Only the faces of the bands are visited.
"""

from dataclasses import replace

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.clean.edge_geometry import edge_lengths
from segcore.clean.surface import Surface
from segcore.coarsen.assembly import CONTACT
from segcore.coarsen.contacts import Links
from segcore.graphs.max_flow import push
from segcore.graphs.mesh_graph import MeshGraph
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.graphs.tree import Tree
from segcore.label.band import Band, Geometry, band_network, free_faces, grow_band
from segcore.label.leaves import (
    Bounds,
    FaceGraph,
    Placement,
    broken_leaves,
    changed_places,
    crossing_edges,
    edges_around,
    move,
)
from segcore.label.mirrored import mirrored_places
from segcore.symmetry.images import MirrorImage

# The first two are compared with their neighbours in bench/RESULTS.md, "Constants and their neighbours", and their
# effect is in "Boundaries" there. The others were set by hand.
BAND = 0.03  # of sqrt(total area), to either side of a boundary
STIFFNESS = 0.1  # added to the affinity in the cost of a boundary, which makes it short if there are few concavities
_MOST_FACES = 16384  # in one band: that of a very fine mesh is narrower, because flows take longer on wide bands
_ATTEMPTS = 3  # at a cut that keeps all parts of the hierarchy connected


def draw_boundaries(
    tree: Tree, nodes: MeshGraph, links: Links, surface: Surface, mirror: MirrorImage | None = None
) -> Tree:
    """Move the boundaries of a tree over the faces of a surface to minimum cuts nearby.

    The cost of a boundary is its length times (g + 0.1), g being the affinity. Every node of the tree that was
    connected stays connected, and every leaf keeps at least half of its faces.

    Parameters
    ----------
    nodes : the face dual graph of the surface.
    links : between its components.
    mirror : the mirror image of the surface, if it is symmetric: one half gets the boundaries of the other.
    """
    if len(tree.split_node) == 0:
        return tree
    length = edge_lengths(surface)
    linked = SurfaceGraph(
        np.concatenate([surface.edge_faces, links.faces]),
        np.concatenate([nodes.graph.weight + STIFFNESS * length, CONTACT * links.length]),
        nodes.graph.volume,
        np.concatenate([length, links.length]),
    )
    drawing = _Drawing(tree, linked, Geometry(surface.edge_vertices, surface.vertices, nodes.points))
    for split in range(len(tree.split_node)):
        drawing.redraw(split)
    if mirror is not None:
        drawing.mirror(linked, mirror)
    return drawing.finished()


class _Drawing:
    """A tree over faces whose boundaries are moved one by one."""

    def __init__(self, tree: Tree, graph: SurfaceGraph, geometry: Geometry) -> None:
        splits = len(tree.split_node)
        self._tree = tree
        self._volume = graph.volume
        self._graph = FaceGraph(graph.edges, graph.weight, graph.rows())
        self._geometry = geometry
        self._width = BAND * float(np.sqrt(graph.total_volume))
        self._intervals = tree.leaf_intervals()
        place = self._intervals.first[tree.leaf]
        split_at = np.zeros(splits + 1, dtype=np.int32)
        split_at[self._intervals.first[2::2]] = np.arange(splits)
        crossing, split = crossing_edges(graph.edges, place, split_at)
        crossings = np.bincount(split, minlength=splits)
        by_split = np.split(crossing[np.argsort(split, kind="stable")], np.cumsum(crossings)[:-1])
        self._edges = [[edges] for edges in by_split]  # of every split, those that crossed it at some time
        self._placement = Placement(place, np.bincount(place, minlength=splits + 1), crossings, split_at)
        self._least = (self._placement.size + 1) // 2
        self._local = np.full(graph.node_count, -1, dtype=np.int32)
        self._arc = np.full(len(graph.edges), -1, dtype=np.int32)
        self._visited = np.zeros(graph.node_count, dtype=bool)

    def redraw(self, split: int) -> None:
        """Move the boundary of a split, unless every attempt breaks a part."""
        bounds = self._bounds(split)
        band = self._band(split, bounds)
        place, size = self._placement.place, self._placement.size
        pinned = np.zeros(len(size), dtype=bool)
        for _ in range(_ATTEMPTS):
            free = free_faces(band, place, size, pinned)
            broken = self._cut(free, bounds)
            if not broken.any():
                return
            pinned |= broken

    def mirror(self, graph: SurfaceGraph, mirror: MirrorImage) -> None:
        """Copy the boundaries of the first half of a symmetric mesh to the second."""
        placement = self._placement
        placement.place[:] = mirrored_places(placement.place, placement.split_at, graph, mirror)

    def _bounds(self, split: int) -> Bounds:
        first, end = self._intervals.first, self._intervals.end
        return Bounds(int(first[2 * split + 1]), int(first[2 * split + 2]), int(end[2 * split + 2]))

    def _band(self, split: int, bounds: Bounds) -> Band:
        """The nearest faces to the boundary of a split, within the width of a band."""
        edges = np.concatenate(self._edges[split])
        band: Band = grow_band(
            edges, self._graph, self._geometry, self._placement.place, bounds, self._width, self._local
        )
        if len(band.faces) <= _MOST_FACES:
            return band
        near = band.distance < np.partition(band.distance, _MOST_FACES)[_MOST_FACES]
        return Band(band.faces[near], band.distance[near])

    def _cut(self, free: IntArray, bounds: Bounds) -> BoolArray:
        """Make the minimum cut of the free faces the boundary, or return the leaves that it would break."""
        place, size = self._placement.place, self._placement.size
        network = band_network(free, self._graph, place, bounds, self._local, self._arc)
        if not (network.excess.max(initial=0.0) > 0.0 > network.excess.min(initial=0.0)):
            return np.zeros(len(size), dtype=bool)
        lower = push(network.arcs, network.capacity, network.excess) == len(free)
        faces, places = changed_places(free, lower, self._graph, place, bounds, self._local)
        before = place[faces]
        crossed = self._placement.crossings > 0
        self._move(faces, places)
        broken = broken_leaves(faces, before, self._placement, self._least, self._graph.rows, self._visited)
        if not broken.any() and (crossed & (self._placement.crossings == 0)).any():
            broken[before] = True
        if broken.any():
            self._move(faces[::-1], before[::-1])
        else:
            self._remember(edges_around(faces, self._graph.rows))
        return broken

    def _move(self, faces: IntArray, places: IntArray) -> None:
        # Arrays in one order, so that the kernel is compiled once.
        move(np.ascontiguousarray(faces), np.ascontiguousarray(places), self._placement, self._graph.rows)

    def _remember(self, edges: IntArray) -> None:
        """Add edges to the lists of the splits that they cross now."""
        edges = np.unique(edges)
        crossing, split = crossing_edges(self._graph.pairs[edges], self._placement.place, self._placement.split_at)
        for crossed in np.unique(split).tolist():
            self._edges[crossed].append(edges[crossing[split == crossed]])

    def finished(self) -> Tree:
        """The tree over the faces, the larger part of every split first again."""
        tree = self._tree
        place_of_node = self._intervals.first
        leaf_at = np.empty(len(self._placement.size), dtype=np.int32)
        leaves = np.setdiff1d(np.arange(len(place_of_node), dtype=np.int32), tree.split_node)
        leaf_at[place_of_node[leaves]] = leaves
        leaf = leaf_at[self._placement.place]
        number = _larger_first(tree, group_sums(leaf, self._volume, len(place_of_node)))
        return replace(tree, split_node=number[tree.split_node], leaf=number[leaf])


def _larger_first(tree: Tree, volume: FloatArray) -> IntArray:
    """(2 S + 1,) new numbers of the nodes, such that the larger child of every node comes first.

    Parameters
    ----------
    volume : (2 S + 1,) of the leaves, 0 for all other nodes.
    """
    volume = volume.copy()
    number = np.arange(len(volume), dtype=np.int32)
    for split in reversed(range(len(tree.split_node))):
        volume[tree.split_node[split]] = volume[2 * split + 1] + volume[2 * split + 2]
        if volume[2 * split + 1] < volume[2 * split + 2]:
            number[[2 * split + 1, 2 * split + 2]] = 2 * split + 2, 2 * split + 1
    return number
