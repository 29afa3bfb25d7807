from dataclasses import replace

import numpy as np

from segcore import shapes
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.clean.refinement import refine
from segcore.clean.surface import build_surface
from segcore.label.pieces import whole_faces
from segcore.parameters import SegmentationParameters

SURFACE = build_surface(shapes.box((10, 1, 0.5)))


def test_an_edge_has_the_mean_affinity_of_the_edges_of_its_pieces():
    refinement = refine(SURFACE)
    pieces = mesh_graph(refinement.surface, SegmentationParameters(), refinement.is_piece)
    graph = whole_faces(pieces, refinement, SURFACE).graph
    assert len(graph.weight) == len(SURFACE.edge_faces)
    for pair, affinity in zip(SURFACE.edge_faces, graph.weight / graph.length, strict=True):
        here = (np.sort(refinement.parent[pieces.graph.edges], axis=1) == np.sort(pair)).all(axis=1)
        assert np.isclose(affinity, pieces.graph.weight[here].sum() / pieces.graph.length[here].sum())


def test_an_edge_whose_pieces_have_none_has_the_mean_affinity_of_all():
    """The borders of two faces that were joined along a gap can lie too far apart after the division."""
    refinement = refine(SURFACE)
    pieces = mesh_graph(refinement.surface, SegmentationParameters(), refinement.is_piece)
    lost = np.sort(SURFACE.edge_faces[0])
    kept = (np.sort(refinement.parent[pieces.graph.edges], axis=1) != lost).any(axis=1)
    assert not kept.all()
    full = pieces.graph
    graph = full._replace(edges=full.edges[kept], weight=full.weight[kept], length=full.length[kept])
    whole = whole_faces(replace(pieces, graph=graph), refinement, SURFACE).graph
    assert np.isclose(whole.weight[0] / whole.length[0], graph.weight.sum() / graph.length.sum())
    np.testing.assert_allclose(whole.weight[1:], whole_faces(pieces, refinement, SURFACE).graph.weight[1:])
