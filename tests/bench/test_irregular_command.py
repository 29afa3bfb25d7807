"""Versions of a shape that keep it, and agreements that can be counted."""

import numpy as np
import pytest

from bench.commands.irregular import render
from bench.princeton.dataset import Model
from bench.remeshing import VERSIONS, Remeshed, agreement, areas, refined
from helpers.strips import cut_at, strip
from segcore import shapes
from segcore.mesh import Mesh

BURR = shapes.burr(3).mesh


@pytest.mark.parametrize("name", VERSIONS)
def test_every_version_keeps_the_area(name):
    version = VERSIONS[name](BURR, np.random.default_rng(0))
    noise = 0.2 if "noise" in name or "decimated" in name else 0.03 if name == "remeshed" else 1e-9
    whole = areas(BURR.vertices, BURR.faces).sum()
    assert areas(version.vertices, version.faces).sum() == pytest.approx(whole, rel=noise)


@pytest.mark.parametrize("name", ["half split twice", "patches refined", "slivers"])
def test_pieces_lie_in_the_faces_they_come_from(name):
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
    assert len(forth) == len(directed)  # closed and consistently oriented: every edge once in either direction
    assert forth == back


def test_agreement_is_by_area_after_the_best_matching():
    vertices, faces = strip(10)
    mesh = Mesh(vertices, faces)
    same = Remeshed(vertices, faces, np.arange(20, dtype=np.int32))
    labels = cut_at(10, 5).astype(np.int32)
    assert agreement(mesh, labels, same, 1 - labels) == pytest.approx(1)
    assert agreement(mesh, labels, same, cut_at(10, 7).astype(np.int32)) == pytest.approx(0.8)


def test_meshes_without_common_faces_are_compared_by_place():
    vertices, faces = strip(10)
    finer, fine_faces = strip(20)
    other = Remeshed(finer * [0.5, 1, 1], fine_faces)
    labels = cut_at(10, 5).astype(np.int32)
    assert agreement(Mesh(vertices, faces), labels, other, cut_at(20, 10).astype(np.int32)) == pytest.approx(1)
    assert agreement(Mesh(vertices, faces), labels, other, cut_at(20, 14).astype(np.int32)) == pytest.approx(0.8)


def test_the_table_has_the_means_of_the_versions(tmp_path):
    models = [Model(number, "Rod", 3, tmp_path, tmp_path) for number in (1, 3)]
    text = render(models, ["slivers", "remeshed"], [[0.9, 1.0], [0.8, 0.96]])
    rows = [line.split() for line in text.splitlines()]
    assert ["slivers", "0.8500", "0.0500", "0.8000", "0%"] in rows
    assert ["remeshed", "0.9800", "0.0200", "0.9600", "100%"] in rows
