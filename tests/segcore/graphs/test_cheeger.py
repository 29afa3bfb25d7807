import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.graphs import graph_of, graphs, laplacian
from segcore.arrays import FloatArray
from segcore.graphs.cheeger import Criterion, Cut, cut_of, cut_weight, level_sets, ncc, ncut, sweep, valley_sides
from segcore.graphs.surface_graph import SurfaceGraph


def valleys(graph: SurfaceGraph, values: FloatArray, most: int) -> list[Cut]:
    return [cut_of(graph, side) for side in valley_sides(level_sets(graph, values), most)]


@given(graphs(connected=False), st.data())
def test_the_values_of_a_cut_are_those_of_the_formulas(graph: SurfaceGraph, data: st.DataObject) -> None:
    side = np.array(data.draw(st.lists(st.booleans(), min_size=graph.node_count, max_size=graph.node_count)))
    S = side.astype(float)
    weight, inside, outside = S @ laplacian(graph) @ S, graph.volume @ S, graph.volume @ (1 - S)
    assert cut_weight(graph, side) == pytest.approx(weight, rel=1e-12, abs=1e-12)
    if 0 < S.sum() < graph.node_count:
        assert ncc(graph, side) == pytest.approx(weight / min(inside, outside), rel=1e-9, abs=1e-9)
        assert ncut(graph, side) == pytest.approx(weight / inside + weight / outside, rel=1e-9, abs=1e-9)
    else:
        assert ncc(graph, side) == ncut(graph, side) == np.inf


@given(graphs(connected=False), st.data(), st.sampled_from(["ncc", "ncut"]))
def test_the_sweep_is_the_best_of_all_thresholds(
    graph: SurfaceGraph, data: st.DataObject, criterion: Criterion
) -> None:
    few = st.integers(0, 3).map(float)  # few values: ties
    values = np.array(data.draw(st.lists(few, min_size=graph.node_count, max_size=graph.node_count)))
    cut = sweep(graph, values, criterion)
    thresholds = np.unique(values)[:-1]
    expected = min((cut_of(graph, values > t).value(criterion) for t in thresholds), default=np.inf)
    assert cut.value(criterion) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@given(graphs(connected=False), st.data())
def test_the_sweep_never_parts_equal_values(graph: SurfaceGraph, data: st.DataObject) -> None:
    few = st.integers(0, 3).map(float)
    values = np.array(data.draw(st.lists(few, min_size=graph.node_count, max_size=graph.node_count)))
    side = sweep(graph, values).side
    assert values[side].min(initial=np.inf) > values[~side].max(initial=-np.inf)


def test_the_criteria_differ() -> None:
    """Volumes 1, 1, 2 on a path: cutting the first node off costs 1 / 1 or 1 + 1/3, the last one 1.9 / 2 or 1.9."""
    graph = graph_of([(0, 1), (1, 2)], [1.0, 1.9], np.array([1.0, 1.0, 2.0]))
    values = np.array([0.0, 1.0, 2.0])
    assert sweep(graph, values, "ncc").side.tolist() == [False, False, True]
    assert sweep(graph, values, "ncut").side.tolist() == [False, True, True]


def test_valleys_are_the_lightest_cuts_along_a_function() -> None:
    """A path of 200 nodes with two thin places: the sweep finds one, the valleys are both, the lighter one first."""
    weight = np.ones(199)
    weight[59], weight[139] = 0.2, 0.1
    graph = graph_of([(i, i + 1) for i in range(199)], weight, np.ones(200))
    values = np.arange(200.0)
    found = [int(cut.side.sum()) for cut in valleys(graph, values, 3)]
    assert found[:2] == [60, 140]
    assert [int(cut.side.sum()) for cut in valleys(graph, -values, 1)] == [140]
    assert valleys(graph, values, 1)[0].weight == pytest.approx(0.1)


def test_a_cut_near_an_end_is_no_valley() -> None:
    weight = np.ones(199)
    weight[1] = 0.1
    graph = graph_of([(i, i + 1) for i in range(199)], weight, np.ones(200))
    assert all(cut.side.sum() < 190 for cut in valleys(graph, np.arange(200.0), 5))
