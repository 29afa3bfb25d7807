import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from helpers.graphs import graphs, is_connected
from segcore.arrays import BoolArray, FloatArray
from segcore.cut.bodies import pieces_of
from segcore.cut.features import FEATURES, cut_features
from segcore.cut.fields import ClusterFields, Segment
from segcore.graphs.cheeger import Cut, cut_of
from segcore.graphs.surface_graph import SurfaceGraph


@st.composite
def cuts_of_segments(draw: st.DrawFn) -> tuple[ClusterFields, Segment, Cut]:
    """A graph of clusters, a connected part of it, and a cut of that part.

    Positions and volumes are short binary fractions, so that sums over one point, or over points at one place, are
    exact.
    """
    drawn = draw(graphs())
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    count = drawn.node_count
    length = rng.uniform(0.1, 1.0, len(drawn.edges))
    whole = SurfaceGraph(
        drawn.edges, length * rng.uniform(0.03, 1.0, len(length)), 2.0 ** rng.integers(-1, 2, count), length
    )
    fields = ClusterFields.of(
        whole,
        rng.integers(0, 8, (count, 3)) / 8,
        rng.integers(-16, 0, count) / 8,
        body=np.unique(rng.integers(0, 3, count), return_inverse=True)[1].astype(np.int32),
        confidence=rng.integers(0, 9, count) / 8,
        open_border=rng.integers(0, 2, count) * 0.5,
        flat=rng.integers(0, 2, len(length)) * 0.75,
        concavity=rng.integers(-4, 5, len(length)) / 4,
    )
    inside = np.array(draw(st.lists(st.booleans(), min_size=count, max_size=count)))
    assume(inside.sum() >= 2 and is_connected(whole, inside))
    nodes = np.flatnonzero(inside).astype(np.int32)
    depth = draw(st.integers(0, 3))
    segment = Segment(nodes, whole.subgraph(nodes), depth, 0.5 * depth)
    side = np.array(draw(st.lists(st.booleans(), min_size=len(nodes), max_size=len(nodes))))
    assume(side.any() and not side.all())
    return fields, segment, cut_of(segment.graph, side)


def plain_features(fields: ClusterFields, segment: Segment, cut: Cut) -> dict[str, float | None]:
    """The features by the formulas of ``CutFeatures``, with weighted means and covariances of numpy."""
    graph = segment.graph
    total = fields.graph.volume.sum()
    size = np.sqrt(total)
    small = cut.side if graph.volume[cut.side].sum() <= graph.volume[~cut.side].sum() else ~cut.side
    crossing = small[graph.edges[:, 0]] != small[graph.edges[:, 1]]
    border = graph.length[crossing].sum()
    affinity = graph.weight[crossing].sum() / border
    thickness = fields.thickness[segment.nodes]
    at_cut = np.average(thickness[graph.edges[crossing]].mean(axis=1), weights=graph.length[crossing])
    one, other = (plain_side(fields, segment, side, border) for side in (small, ~small))
    ncut = np.log(cut.weight * (1 / one["area"] + 1 / other["area"]) * size)
    parent = np.log(segment.parent_ncut * size) if segment.parent_ncut else 0.0
    return {
        "ncut": ncut,
        "ncc": np.log(cut.weight / min(one["area"], other["area"]) * size),
        "small_area": np.log(one["area"] / total),
        "large_area": np.log(other["area"] / total),
        "balance": np.log(one["area"] / other["area"]),
        "affinity": np.log(affinity),
        "affinity_contrast_small": np.log(affinity / one["affinity"]),
        "affinity_contrast_large": np.log(affinity / other["affinity"]),
        "border": np.log(border / size),
        "border_over_small": np.log(border / np.sqrt(one["area"])),
        "border_over_large": np.log(border / np.sqrt(other["area"])),
        "border_over_girth": np.log(border / (size * np.exp(at_cut))),
        "small_closed": one["closed"],
        "large_closed": other["closed"],
        "small_thickness": one["thickness"],
        "large_thickness": other["thickness"],
        "neck": at_cut - min(one["thickness"], other["thickness"]),
        "thickness_step": abs(one["thickness"] - other["thickness"]),
        "small_thickness_spread": one["spread"],
        "large_thickness_spread": other["spread"],
        "small_flatness": one["flatness"],
        "small_roundness": one["roundness"],
        "large_flatness": other["flatness"],
        "large_roundness": other["roundness"],
        "depth": np.log(1 + segment.depth),
        "parent_ncut": parent,
        "against_parent": ncut - parent if segment.parent_ncut else 0.0,
        **plain_body_features(fields, segment, small, border),
    }


def plain_body_features(
    fields: ClusterFields, segment: Segment, small: BoolArray, border: float
) -> dict[str, float | None]:
    """The features by the formulas of ``BodyFeatures``; None if it depends on the choice of equal principal axes."""
    graph, nodes = segment.graph, segment.nodes
    body, points, volume = fields.bodies.of_cluster[nodes], fields.points[nodes], graph.volume
    crossing = small[graph.edges[:, 0]] != small[graph.edges[:, 1]]
    contact = crossing & (body[graph.edges[:, 0]] != body[graph.edges[:, 1]])
    piece = pieces_of(graph, body)
    in_both = np.intersect1d(piece[small], piece[~small])
    area = [volume[side].sum() for side in (small, ~small)]
    centre = [np.average(points[side], axis=0, weights=volume[side]) for side in (small, ~small)]
    spread = [
        np.average(((points[side] - c) ** 2).sum(axis=1), weights=volume[side])
        for side, c in zip((small, ~small), centre, strict=True)
    ]
    of_body = [np.bincount(body[side], volume[side], len(fields.bodies.area)) for side in (small, ~small)]
    is_whole = [amount >= fields.bodies.area * (1 - 1e-9) for amount in of_body]
    touched = of_body[0] > 0
    is_one = touched.sum() == 1 and is_whole[0][touched].all()
    index = {tuple(edge): place for place, edge in enumerate(fields.graph.edges.tolist())}
    whole_edge = np.array([index[tuple(sorted(nodes[edge].tolist()))] for edge in graph.edges])
    in_contact = graph.length[contact]
    inside = fields.bodies.of_cluster[fields.graph.edges]
    same = inside[:, 0] == inside[:, 1]
    mean_affinity = fields.graph.weight[same].sum() / fields.graph.length[same].sum() if same.any() else 1.0
    return {
        "contact_share": in_contact.sum() / border,
        "contact_over_small": np.log(in_contact.sum() / np.sqrt(area[0]) + 1e-4),
        "contact_concavity": in_contact @ fields.concavity[whole_edge[contact]] / in_contact.sum()
        if len(in_contact)
        else 0.0,
        "small_pieces": np.log(1 + len(np.unique(piece[small]))),
        "large_pieces": np.log(1 + len(np.unique(piece[~small]))),
        "divided": volume[np.isin(piece, in_both)].sum() / sum(area),
        "small_whole": of_body[0][is_whole[0]].sum() / area[0],
        "large_whole": of_body[1][is_whole[1]].sum() / area[1],
        "small_of_body": np.log(area[0] / fields.bodies.area[touched].sum()),
        "small_inside": None,
        "centre_distance": np.log(np.linalg.norm(centre[0] - centre[1]) / np.sqrt(area[0]) + 1e-12),
        "small_compactness": np.log(area[0] / (spread[0] + 1e-12)),
        "large_compactness": np.log(area[1] / (spread[1] + 1e-12)),
        "small_open": np.log(1 + fields.open_border[nodes[small]].sum() / np.sqrt(area[0])),
        "large_open": np.log(1 + fields.open_border[nodes[~small]].sum() / np.sqrt(area[1])),
        "small_confidence": np.average(fields.confidence[nodes[small]], weights=volume[small]),
        "large_confidence": np.average(fields.confidence[nodes[~small]], weights=volume[~small]),
        "repeats": np.log(fields.bodies.repeats[np.argmax(touched)]) if is_one else 0.0,
        "flat_share": (graph.length * fields.flat[whole_edge])[crossing].sum() / border,
        "bodies": np.log(fields.bodies.count),
        "mean_affinity": np.log(mean_affinity),
    }


def plain_side(fields: ClusterFields, segment: Segment, side: BoolArray, border: float) -> dict[str, float]:
    whole, graph = fields.graph, segment.graph
    nodes, volume = segment.nodes[side], graph.volume[side]
    inside = side[graph.edges].all(axis=1)
    outline = whole.length[np.isin(whole.edges, nodes).sum(axis=1) == 1].sum()
    thickness = fields.thickness[nodes]
    mean = np.average(thickness, weights=volume)
    spread = np.sqrt(np.average((thickness - mean) ** 2, weights=volume))
    variance = np.linalg.eigvalsh(np.cov(fields.points[nodes].T, aweights=volume, ddof=0))
    deviation = np.sqrt(np.maximum(variance, 0) / max(variance[2], 1e-12))
    return {
        "area": volume.sum(),
        "affinity": graph.weight[inside].sum() / graph.length[inside].sum() if inside.any() else 1.0,
        "closed": border / outline,
        "thickness": mean,
        "spread": spread,
        "flatness": deviation[0],
        "roundness": deviation[1],
    }


@given(cuts_of_segments())
def test_the_features_are_those_of_the_formulas(case: tuple[ClusterFields, Segment, Cut]) -> None:
    expected = plain_features(*case)
    assert tuple(expected) == FEATURES
    found = dict(zip(FEATURES, features_of(*case), strict=True))
    known = [name for name in FEATURES if expected[name] is not None]
    np.testing.assert_allclose([found[n] for n in known], [expected[n] for n in known], atol=1e-6)
    assert 0.0 <= found["small_inside"] <= 1.0


def features_of(fields: ClusterFields, segment: Segment, cut: Cut) -> FloatArray:
    return cut_features(fields, segment, fields.inside(segment), cut.side[None])[0]


def test_the_small_side_is_inside_the_box_of_the_other_side_or_not() -> None:
    """A plus of nodes in a plane, with one more node inside or outside of its box."""
    around = [[-2, 0, 0], [2, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, 0.5], [0, 0, -0.5]]
    edges = np.array([[i, j] for i in range(7) for j in range(i + 1, 7)], dtype=np.int32)
    graph = SurfaceGraph(edges, np.full(len(edges), 0.5), np.ones(7), np.ones(len(edges)))
    segment = Segment(np.arange(7, dtype=np.int32), graph, 0, 0.0)
    for place, inside in (([1.0, 0.5, 0.25], 1.0), ([1.0, 1.5, 0.25], 0.0)):
        fields = ClusterFields.of(graph, np.array([*around, place]), np.zeros(7))
        found = features_of(fields, segment, cut_of(graph, np.arange(7) == 6))
        assert found[FEATURES.index("small_inside")] == inside


@settings(suppress_health_check=[HealthCheck.filter_too_much])
@given(cuts_of_segments())
def test_the_features_do_not_depend_on_which_side_is_which(case: tuple[ClusterFields, Segment, Cut]) -> None:
    fields, segment, cut = case
    assume(cut.inside != cut.outside)
    other = cut_of(segment.graph, ~cut.side)
    np.testing.assert_allclose(features_of(fields, segment, cut), features_of(fields, segment, other), atol=1e-7)


def test_the_features_do_not_change_with_the_unit_of_length() -> None:
    rng = np.random.default_rng(0)
    edges = np.array([[i, j] for i in range(12) for j in range(i + 1, 12) if rng.random() < 0.5], np.int32)
    length, volume = rng.uniform(0.1, 1, len(edges)), rng.uniform(0.5, 1, 12)
    points, thickness = rng.random((12, 3)), rng.uniform(-2, 0, 12)
    nodes = np.arange(12, dtype=np.int32)
    found = []
    for unit in (1.0, 32.0):
        graph = SurfaceGraph(edges, 0.3 * unit * length, unit**2 * volume, unit * length)
        segment = Segment(nodes, graph, 0, 0.0)
        fields = ClusterFields.of(graph, unit * points, thickness)
        found.append(features_of(fields, segment, cut_of(graph, nodes < 5)))
    assert found[1] == pytest.approx(found[0], abs=1e-9)
