"""Other meshes of a shape: they keep its area and fit together."""

import numpy as np
import pytest

from bench.cad import cad_meshes
from bench.irregular.agreement import areas
from bench.irregular.versions import VERSIONS, refined
from segcore import shapes
from segcore.part_list.surface_distance import SurfaceDistance

BURR = shapes.burr(3).mesh


@pytest.mark.parametrize("name", VERSIONS)
def test_every_version_keeps_the_area(name):
    version = VERSIONS[name](BURR, np.random.default_rng(0))
    noise = 0.2 if "noise" in name or "decimated" in name else 0.03 if name == "remeshed" else 1e-9
    whole = areas(BURR.vertices, BURR.faces).sum()
    assert areas(version.vertices, version.faces).sum() == pytest.approx(whole, rel=noise)


@pytest.mark.parametrize("solid", ["shaft", "gear", "spool"])
def test_a_decimated_solid_keeps_its_shape(solid):
    mesh = cad_meshes()[solid]
    version = VERSIONS["80 % decimated"](mesh, np.random.default_rng(0))
    assert len(version.faces) < 0.8 * len(mesh.faces)
    distance = SurfaceDistance(version.vertices, version.faces)(mesh.vertices)
    assert distance.max() < 0.03 * np.ptp(mesh.vertices, axis=0).max()


@pytest.mark.parametrize("name", ["half split twice", "patches refined", "slivers"])
def test_the_area_of_a_face_is_that_of_its_pieces(name):
    version = VERSIONS[name](BURR, np.random.default_rng(0))
    assert version.origin is not None
    assert len(version.faces) > len(BURR.faces)
    piece = areas(version.vertices, version.faces)
    whole = areas(BURR.vertices, BURR.faces)
    np.testing.assert_allclose(np.bincount(version.origin, piece, len(BURR.faces)), whole)


@pytest.mark.parametrize("seed", range(3))
def test_refined_meshes_fit_together(seed):
    chosen = np.random.default_rng(seed).random(len(BURR.faces)) < 0.3
    version = refined(BURR, chosen)
    directed = version.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    forth, back = {tuple(edge) for edge in directed.tolist()}, {tuple(edge[::-1]) for edge in directed.tolist()}
    assert len(forth) == len(directed)  # closed and consistently oriented: every edge once in each direction
    assert forth == back
