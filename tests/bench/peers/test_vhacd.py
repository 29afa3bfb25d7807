"""V-HACD with given hulls."""

from importlib.metadata import PackageNotFoundError

import numpy as np
import pytest

from bench.errors import BenchmarkError
from bench.peers.method import MethodFailed
from bench.peers.vhacd import VHacd, distance_to_hull
from segcore.shapes import box, dumbbell


def test_the_distance_to_a_box_does_not_depend_on_the_orientation_of_its_faces() -> None:
    mesh = box((2, 2, 2))
    points = np.array([[0, 0, 0], [0.75, 0, 0.1], [1, 0.2, 0.3], [0.5, 0, -4]])
    faces = mesh.faces.copy()
    faces[::2] = faces[::2, ::-1]
    assert np.allclose(distance_to_hull(points, mesh.vertices, faces), [-1, -0.25, 0, 3])


def test_every_face_belongs_to_the_nearest_hull(monkeypatch: pytest.MonkeyPatch) -> None:
    # Two hulls, around the lower and the upper ball of a dumbbell, that overlap at the neck.
    shape = dumbbell(rings=24, around=16)
    hulls = [box((2, 2, 3.2), (0, 0, side * 1.5)) for side in (-1, 1)]
    parts = [{"vertices": hull.vertices, "faces": hull.faces} for hull in hulls]
    monkeypatch.setattr("trimesh.decomposition.convex_decomposition", lambda *_, **__: parts)
    labels = VHacd()(shape.mesh, 2).labels
    assert np.array_equal(labels, (shape.mesh.corners[:, :, 2].mean(axis=1) > 0).astype(np.int32))


def test_no_hull_is_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("trimesh.decomposition.convex_decomposition", lambda *_, **__: [])
    with pytest.raises(MethodFailed, match="no part"):
        VHacd()(box(), 2)


def test_a_missing_package_is_an_error_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> str:
        raise PackageNotFoundError(name)

    monkeypatch.setattr("bench.peers.vhacd.version", missing)
    with pytest.raises(BenchmarkError, match="pip install vhacdx"):
        VHacd().prepare()
