from dataclasses import replace

import numpy as np

from segcore import shapes
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.clean.edge_geometry import edge_lengths
from segcore.clean.refinement import refine
from segcore.clean.surface import build_surface
from segcore.coarsen.contacts import Links
from segcore.label.pieces import links_of_faces, whole_faces
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


def test_faces_that_only_their_pieces_connect_are_linked():
    """Patches can be stitched along more of their borders once these are divided."""
    refinement = refine(SURFACE)
    pieces = mesh_graph(refinement.surface, SegmentationParameters(), refinement.is_piece)
    apart = replace(SURFACE, edge_faces=SURFACE.edge_faces[1:], edge_vertices=SURFACE.edge_vertices[1:])
    links = links_of_faces(Links.none(), pieces, refinement, apart)
    assert {tuple(sorted(pair)) for pair in links.faces.tolist()} == {tuple(sorted(SURFACE.edge_faces[0].tolist()))}
    assert np.isclose(links.length.sum(), edge_lengths(SURFACE)[0])
    assert len(links.concavity) == len(links.faces)


def test_links_of_pieces_are_links_of_their_faces():
    refinement = refine(SURFACE)
    pieces = mesh_graph(refinement.surface, SegmentationParameters(), refinement.is_piece)
    ends = np.array([[0, len(refinement.parent) - 1]], dtype=np.int32)
    links = links_of_faces(Links(ends, np.ones(1), np.zeros(1)), pieces, refinement, SURFACE)
    assert links.faces.tolist() == [[0, len(SURFACE.faces) - 1]]
