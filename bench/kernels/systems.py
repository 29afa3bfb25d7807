"""Linear systems with graph Laplacians: sparse elimination of Cleave beside SuperLU."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from bench.kernels.timing import cpu_s
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.affinity.patches import patches_of
from segcore.clean.edge_geometry import EdgeGeometry
from segcore.clean.surface import build_surface
from segcore.coarsen.clusters import cluster_nodes
from segcore.graphs.laplacian import factorise_edges
from segcore.graphs.ordering import minimum_degree
from segcore.graphs.surface_graph import rows_of
from segcore.parameters import SegmentationParameters

if TYPE_CHECKING:
    from segcore.arrays import FloatArray, IntArray
    from segcore.mesh import Mesh

SMOOTHING_RADIUS = 0.06  # in sqrt(total area), as that of the thickness
WEAKEST_BRIDGE = 1e-15

Solve: TypeAlias = Callable[["FloatArray"], "FloatArray"]
Ordering: TypeAlias = Literal["NATURAL", "MMD_AT_PLUS_A", "COLAMD"]


@dataclass(frozen=True, slots=True)
class Laplacian:
    """The Laplacian of a connected graph, of which the last node is held at 0."""

    edges: IntArray  # (E, 2)
    weight: FloatArray  # (E,)
    node_count: int

    @property
    def matrix(self) -> csc_matrix[Any]:
        """(N - 1, N - 1) without the last row and column, which makes it positive definite."""
        a, b = self.edges.T
        diagonal = np.bincount(self.edges.ravel(), np.repeat(self.weight, 2), self.node_count)
        nodes = np.arange(self.node_count)
        entries = np.concatenate([diagonal, -self.weight, -self.weight])
        places = (np.concatenate([nodes, a, b]), np.concatenate([nodes, b, a]))
        full = csc_matrix((entries, places), shape=(self.node_count, self.node_count))
        return csc_matrix(full[:-1, :-1])


@dataclass(frozen=True, slots=True)
class Factored:
    """A factorised Laplacian."""

    entries: int  # below the diagonal of the factor
    solve: Solve  # from (N - 1,) to (N - 1,)


@dataclass(frozen=True, slots=True)
class SystemTimes:
    """The cost of a method for one system."""

    entries: int
    factorise_s: float
    solve_s: float


def coarse_laplacian(mesh: Mesh) -> Laplacian:
    """The Laplacian of the graph of clusters that Cleave makes of a mesh at the default parameters."""
    parameters = SegmentationParameters()
    nodes = mesh_graph(build_surface(mesh), parameters)
    graph = cluster_nodes(nodes, parameters.clusters, np.random.default_rng(parameters.seed)).graph
    return Laplacian(graph.edges, graph.weight, graph.node_count)


def smoothing_laplacian(mesh: Mesh) -> Laplacian:
    """The matrix by which values on the patches of a mesh are smoothed; the area is the weight to one more node."""
    surface = build_surface(mesh)
    edges = EdgeGeometry.of(surface)
    patches = patches_of(surface, np.ones(len(edges.length)), edges.positive_length, np.random.default_rng(0))
    count = len(patches.area)
    radius = SMOOTHING_RADIUS * np.sqrt(patches.area.sum())
    spokes = np.stack([np.arange(count), np.full(count, count)], axis=1).astype(np.int32)
    exchange = radius**2 / 6 * patches.border / patches.distance
    return Laplacian(np.concatenate([patches.pairs, spokes]), np.concatenate([exchange, patches.area]), count + 1)


def cleave(system: Laplacian) -> Factored:
    factor = factorise_edges(system.edges, system.weight, system.node_count)

    def solve(b: FloatArray) -> FloatArray:
        x = factor.solve(np.append(b, -b.sum()))
        held: FloatArray = x[:-1] - x[-1]
        return held

    return Factored(len(factor.row), solve)


def superlu(matrix: csc_matrix[Any], ordering: Ordering) -> Factored:
    """SuperLU without pivoting, for symmetric matrices, with one of its own orderings."""
    factor = splu(matrix, permc_spec=ordering, diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return Factored(factor.L.nnz - matrix.shape[0], factor.solve)


def superlu_in_our_order(system: Laplacian, matrix: csc_matrix[Any]) -> Factored:
    """SuperLU with the ordering of Cleave."""
    edges = system.edges[(system.edges < system.node_count - 1).all(axis=1)]
    order = minimum_degree(rows_of(edges, system.node_count - 1))
    factor = superlu(csc_matrix(matrix[order][:, order]), "NATURAL")
    place = np.argsort(order)
    return Factored(factor.entries, lambda b: factor.solve(b[order])[place])


def methods(system: Laplacian) -> dict[str, Callable[[], Factored]]:
    """Return the methods by name; calling one factorises the system, whose matrix is built in advance."""
    matrix = system.matrix
    return {
        "Cleave": partial(cleave, system),
        "SuperLU, ordering of Cleave": partial(superlu_in_our_order, system, matrix),
        "SuperLU, MMD_AT_PLUS_A": partial(superlu, matrix, "MMD_AT_PLUS_A"),
        "SuperLU, COLAMD": partial(superlu, matrix, "COLAMD"),
    }


def measure(system: Laplacian, runs: int) -> dict[str, SystemTimes]:
    """Return the times of every method."""
    b = np.random.default_rng(0).standard_normal(system.node_count - 1)
    return {name: _measured(factorise, b, runs) for name, factorise in methods(system).items()}


def _measured(factorise: Callable[[], Factored], b: FloatArray, runs: int) -> SystemTimes:
    factored = factorise()
    return SystemTimes(factored.entries, cpu_s(factorise, runs), cpu_s(partial(factored.solve, b), runs))


def bridge_errors(size: int = 20) -> dict[str, float]:
    """The relative error of every method in the potential across a weak bridge between two cliques.

    A unit of flow goes over a bridge of weight 1e-15, which makes the difference of the potentials of its ends 1e15.
    """
    clique = [(i, j) for j in range(size) for i in range(j)]
    pairs = [*clique, *((i + size, j + size) for i, j in clique), (size - 1, size)]
    weight = np.append(np.ones(2 * len(clique)), WEAKEST_BRIDGE)
    system = Laplacian(np.array(pairs, dtype=np.int32), weight, 2 * size)
    b = np.zeros(2 * size - 1)
    b[0] = 1.0
    return {name: _bridge_error(factorise, b, size) for name, factorise in methods(system).items()}


def _bridge_error(factorise: Callable[[], Factored], b: FloatArray, size: int) -> float:
    try:
        x = factorise().solve(b)
    except RuntimeError:  # SuperLU: the factor is exactly singular
        return float("inf")
    return float(abs(WEAKEST_BRIDGE * (x[size - 1] - x[size]) - 1.0))
