"""Agreements of segmentations that can be computed by hand."""

import numpy as np
import pytest

from bench.irregular.agreement import agreement
from bench.irregular.versions import Remeshed
from helpers.bench.strips import cut_at, strip
from segcore.mesh import Mesh


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
