"""Files that other programs write are read with every vertex and face in its place."""

import io
from pathlib import Path

import meshio
import numpy as np
import pytest
import trimesh

from helpers.files.polygon_soups import read
from segcore.io import read_mesh
from segcore.mesh import Mesh


@pytest.fixture(scope="module")
def knot() -> trimesh.Trimesh:
    """A twisted ring whose faces are in no particular order."""
    ring = trimesh.creation.torus(1.0, 0.3, 16, 9)
    order = np.random.default_rng(5).permutation(len(ring.faces))
    vertices = (ring.vertices * [1, 2, 0.5] + 0.1).astype(np.float32).astype(np.float64)
    return trimesh.Trimesh(vertices, ring.faces[order], process=False)


def assert_same_faces(mesh: Mesh, vertices: np.ndarray, faces: np.ndarray, tolerance: float = 0.0) -> None:
    assert mesh.corners.shape == (len(faces), 3, 3)
    np.testing.assert_allclose(mesh.corners, vertices[faces], rtol=0, atol=tolerance)


@pytest.mark.parametrize("kind", ["off", "stl", "stl_ascii", "obj", "glb"])
def test_files_of_trimesh(knot: trimesh.Trimesh, kind: str) -> None:
    data = knot.export(file_type=kind)
    mesh = read(data.encode() if isinstance(data, str) else data)
    assert_same_faces(mesh, knot.vertices, knot.faces, 1e-7)


@pytest.mark.parametrize("encoding", ["ascii", "binary"])
@pytest.mark.parametrize("normals", [True, False])
def test_ply_files_of_trimesh(knot: trimesh.Trimesh, encoding: str, normals: bool) -> None:
    colored = knot.copy()
    colored.visual.face_colors = np.random.default_rng(0).integers(0, 255, (len(knot.faces), 4), dtype=np.uint8)
    data = trimesh.exchange.ply.export_ply(colored, encoding=encoding, vertex_normal=normals)
    assert_same_faces(read(data), knot.vertices, knot.faces, 1e-7)


def test_a_scene_of_trimesh_with_instances(knot: trimesh.Trimesh) -> None:
    scene = trimesh.Scene()
    scene.add_geometry(knot, "knot")
    turned = trimesh.transformations.rotation_matrix(0.7, [1, 2, 3], [4, 5, 6])
    scene.add_geometry(knot, "turned knot", transform=turned)
    mesh = read(scene.export(file_type="glb"))
    expected = scene.to_geometry()
    ours, theirs = (np.sort(corners.reshape(-1, 9), axis=0) for corners in (mesh.corners, expected.triangles))
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-5)


@pytest.mark.parametrize("kind", ["off", "obj", "stl", "ply"])
@pytest.mark.parametrize("binary", [True, False])
def test_files_of_meshio(knot: trimesh.Trimesh, kind: str, binary: bool, tmp_path: Path) -> None:
    path = tmp_path / f"knot.{kind}"
    options = {"binary": binary} if kind in ("stl", "ply") else {}
    meshio.Mesh(knot.vertices, [("triangle", knot.faces)]).write(path, **options)
    assert_same_faces(read_mesh(path), knot.vertices, knot.faces, 1e-7)


@pytest.mark.parametrize("binary", [True, False])
def test_mixed_polygons_of_meshio(binary: bool, tmp_path: Path) -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]], dtype=np.float64)
    blocks = [("triangle", [[0, 1, 4]]), ("quad", [[0, 1, 2, 3]]), ("triangle", [[1, 2, 4], [3, 0, 4]])]
    path = tmp_path / "roof.ply"
    meshio.Mesh(points, blocks).write(path, binary=binary)
    mesh = read_mesh(path)
    assert mesh.faces.tolist() == [[0, 1, 4], [0, 1, 2], [0, 2, 3], [1, 2, 4], [3, 0, 4]]
    assert mesh.source_polygon is not None
    assert mesh.source_polygon.tolist() == [0, 1, 1, 2, 3]


def test_a_file_object_of_any_kind_is_enough(knot: trimesh.Trimesh) -> None:
    """Uploads are raw streams, whose ``read`` may return fewer bytes than requested."""

    class Trickle(io.RawIOBase):
        def __init__(self, data: bytes) -> None:
            self._data = io.BytesIO(data)

        def read(self, size: int = -1) -> bytes:
            return self._data.read(min(size, 7) if size >= 0 else 7)

    data = knot.export(file_type="stl")
    assert_same_faces(read_mesh(Trickle(data)), knot.vertices, knot.faces, 1e-7)
