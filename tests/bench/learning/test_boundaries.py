"""The rows of the boundary model."""

from pathlib import Path

import numpy as np

from bench.learning.boundaries import boundary_rows, cut_share
from bench.learning.examples import Example
from bench.princeton.dataset import read_models
from segcore.clean.surface import build_surface


def test_edges_along_the_cut_of_a_person_have_the_share_1_and_others_nearly_0(shapes_folder: Path) -> None:
    model = read_models(shapes_folder)[2]
    mesh = model.read_mesh()
    surface = build_surface(mesh)
    labels = model.read_people(len(mesh.faces))[0]
    share = cut_share(surface, [labels])
    cut = labels[surface.edge_faces[:, 0]] != labels[surface.edge_faces[:, 1]]
    np.testing.assert_allclose(share[cut], 1.0)
    assert share[~cut].mean() < 0.1
    rows = boundary_rows(Example(model, 1.0))
    assert np.isclose(rows.weight.sum(), 1)
    assert np.isclose(np.dot(rows.weight, rows.target), np.average(share, weights=_lengths(surface)), rtol=0.2)


def _lengths(surface):  # type: ignore[no-untyped-def]
    ends = surface.vertices[surface.edge_vertices]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
