"""Small graphs for the tests of the solvers: random ones, some with a known best cut, and brute force."""

from itertools import combinations

import numpy as np
from hypothesis import strategies as st

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.graphs.cheeger import Cut, cut_of
from segcore.graphs.max_flow import Network
from segcore.graphs.surface_graph import SurfaceGraph, connected_components, weighted_degrees
from segcore.solvers import flow


def weighted_graph(edges: IntArray, weight: FloatArray, volume: FloatArray) -> SurfaceGraph:
    """A graph of affinity 1: the lengths are the weights."""
    return SurfaceGraph(edges, weight, volume, length=weight)


def graph_of(
    pairs: list[tuple[int, int]], weight: list[float] | None = None, volume: FloatArray | None = None
) -> SurfaceGraph:
    """A graph from any list of pairs; by default of weights 1, the volumes being the degrees."""
    edges = np.sort(np.array(pairs, dtype=np.int32).reshape(-1, 2), axis=1)
    weights = np.ones(len(edges)) if weight is None else np.array(weight, dtype=np.float64)
    degrees = weighted_degrees(edges, weights, int(edges.max()) + 1) if volume is None else volume
    return weighted_graph(edges, weights, degrees)


def path(node_count: int) -> SurfaceGraph:
    """Nodes 0, 1, ... in a row."""
    return graph_of([(i, i + 1) for i in range(node_count - 1)])


def cycle(node_count: int) -> SurfaceGraph:
    """Nodes 0, 1, ... in a ring."""
    return graph_of([(i, (i + 1) % node_count) for i in range(node_count)])


def two_cliques(size: int, bridge: float = 1.0) -> SurfaceGraph:
    """Nodes 0..size - 1 and size..2 size - 1 are cliques; one edge joins them."""
    clique = list(combinations(range(size), 2))
    pairs = clique + [(a + size, b + size) for a, b in clique] + [(size - 1, size)]
    return graph_of(pairs, [1.0] * (len(pairs) - 1) + [bridge])


def grid(rows: int, columns: int) -> SurfaceGraph:
    """Four neighbours, unit weights, unit volumes; node (i, j) is i * columns + j."""
    node = np.arange(rows * columns, dtype=np.int32).reshape(rows, columns)
    across = np.stack([node[:, :-1].ravel(), node[:, 1:].ravel()], axis=1)
    down = np.stack([node[:-1].ravel(), node[1:].ravel()], axis=1)
    edges = np.concatenate([across, down])
    return weighted_graph(edges, np.ones(len(edges)), np.ones(rows * columns))


@st.composite
def graphs(draw: st.DrawFn, most_nodes: int = 9, decades: float = 1.0, connected: bool = True) -> SurfaceGraph:
    """Any graph without loops, with weights and volumes over some decades; volumes are degrees in half of the cases."""
    node_count = draw(st.integers(2, most_nodes))
    pairs = list(combinations(range(node_count), 2))
    chosen = set(draw(st.lists(st.sampled_from(pairs), min_size=1)))
    if connected:
        chosen |= {(draw(st.integers(0, i - 1)), i) for i in range(1, node_count)}
    values = st.floats(-decades, decades).map(lambda exponent: 10.0**exponent)
    weight = draw(st.lists(values, min_size=len(chosen), max_size=len(chosen)))
    volume = np.array(draw(st.lists(values, min_size=node_count, max_size=node_count)))
    graph = graph_of(sorted(chosen), weight, volume)
    if connected and draw(st.booleans()):
        return weighted_graph(graph.edges, graph.weight, graph.degrees())
    return graph


def is_connected(graph: SurfaceGraph, nodes: BoolArray) -> bool:
    """Whether a set of nodes, at least one, is connected by the edges inside it."""
    part = graph.subgraph(np.flatnonzero(nodes).astype(np.int32))
    return bool(connected_components(part.edges, part.node_count).max() == 0)


def laplacian(graph: SurfaceGraph) -> FloatArray:
    """(N, N) dense L = diag(degree) - W, added up edge by edge."""
    L = np.zeros((graph.node_count, graph.node_count))
    for (a, b), weight in zip(graph.edges.tolist(), graph.weight.tolist(), strict=True):
        L[a, b] -= weight
        L[b, a] -= weight
        L[a, a] += weight
        L[b, b] += weight
    return L


def all_sides(node_count: int) -> BoolArray:
    """(2^N, N) every set of nodes."""
    return (np.arange(2**node_count)[:, None] >> np.arange(node_count)) % 2 == 1


def cuts(graph: SurfaceGraph, sides: BoolArray) -> FloatArray:
    """(M,) cut(S, rest) of every row of ``sides``."""
    crossing = sides[:, graph.edges[:, 0]] != sides[:, graph.edges[:, 1]]
    values: FloatArray = crossing @ graph.weight
    return values


def best_ncc(graph: SurfaceGraph) -> float:
    """The least normalized Cheeger cut of all bipartitions."""
    sides = all_sides(graph.node_count)[1:-1]
    inside = sides @ graph.volume
    outside = ~sides @ graph.volume
    return float((cuts(graph, sides) / np.minimum(inside, outside)).min())


def improve(graph: SurfaceGraph, side: BoolArray) -> Cut:
    """The cut that maximum flows make of a bipartition (N,)."""
    return flow.improve(Network.of(graph), cut_of(graph, side))


def mesh_like(seed: int, rows: int = 20, columns: int = 30) -> SurfaceGraph:
    """A grid with random weights over two decades and random volumes: without symmetry, the best cut unknown."""
    rng = np.random.default_rng(seed)
    graph = grid(rows, columns)
    return weighted_graph(
        graph.edges, 10.0 ** rng.uniform(-2, 0, len(graph.edges)), rng.uniform(0.5, 2, graph.node_count)
    )
