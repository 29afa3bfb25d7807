import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from helpers.graphs import all_sides, cuts, graphs, mesh_like
from segcore.graphs.max_flow import Network
from segcore.graphs.surface_graph import SurfaceGraph


@given(graphs(), st.data())
def test_no_set_has_a_smaller_cut_less_its_supply(graph: SurfaceGraph, data: st.DataObject) -> None:
    entry = st.floats(-3, 3)
    supply = np.array(data.draw(st.lists(entry, min_size=graph.node_count, max_size=graph.node_count)))
    supply -= supply.mean()
    sides = all_sides(graph.node_count)
    values = cuts(graph, sides) - sides @ supply
    found = Network.of(graph).minimum_cut(supply)
    assert cuts(graph, found[None])[0] - found @ supply <= values.min() + 1e-9


@given(st.integers(0, 1000))
def test_the_cut_of_a_large_graph_is_a_local_minimum_too(seed: int) -> None:
    """Compare with independent bounds: the set with any one node flipped, and the set of the positive supplies."""
    graph = mesh_like(seed)
    rng = np.random.default_rng(seed)
    supply = np.repeat(rng.standard_normal(graph.node_count // 20), 20)
    supply -= supply.mean()
    found = Network.of(graph).minimum_cut(supply)
    value = cuts(graph, found[None])[0] - found @ supply
    flipped = found[None] ^ np.eye(graph.node_count, dtype=bool)
    assert value <= (cuts(graph, flipped) - flipped @ supply).min() + 1e-9
    assert value <= (cuts(graph, (supply > 0)[None])[0] - supply[supply > 0].sum()) + 1e-9
