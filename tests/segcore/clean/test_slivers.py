"""Faces without a reliable normal continue the face at their longest edge."""

import numpy as np
import pytest

from bench.cad import cad_meshes
from helpers.bodies.slivers import creased_faces, with_slivers
from segcore.clean.edge_geometry import dihedral_angles, edge_lengths
from segcore.clean.orientation import reliable_normals
from segcore.clean.refinement import refine
from segcore.clean.slivers import with_borrowed_normals
from segcore.clean.surface import Surface, build_surface
from segcore.clean.topology import DualEdges
from segcore.mesh import Mesh
from segcore.method import segment


@pytest.fixture(scope="module")
def meshes() -> dict[str, Mesh]:
    return cad_meshes()


def concave_length(surface: Surface) -> float:
    return float(edge_lengths(surface)[dihedral_angles(surface) < np.deg2rad(-20.0)].sum())


def slivers_at_creases(mesh: Mesh, at: float = 0.37) -> Mesh:
    surface = build_surface(mesh)
    return with_slivers(mesh, at, creased_faces(mesh, surface.edge_faces, dihedral_angles(surface)))


def test_a_sliver_has_the_normal_of_the_face_at_its_longest_edge() -> None:
    """A roof of two faces; the sliver is beside the face 2, which is at the whole ridge."""
    vertices = np.array([[0, 0, 1], [4, 0, 1], [1, 0, 1], [2, 2, 0], [2, -2, 0]], dtype=float)
    surface = build_surface(Mesh(vertices, np.array([[0, 2, 3], [2, 1, 3], [1, 0, 4], [0, 1, 2]])))
    assert surface.areas[3] == 0.0
    np.testing.assert_array_equal(surface.normals[3], surface.normals[2])
    at_sliver = (surface.edge_faces == 3).any(axis=1)
    angles = dihedral_angles(surface)[at_sliver][np.argsort(surface.edge_faces[at_sliver].min(axis=1))]
    np.testing.assert_allclose(np.abs(angles), [2 * np.arctan(0.5), 2 * np.arctan(0.5), 0])


def borrowed(normals: np.ndarray, faces: list[list[int]], length: list[float]) -> np.ndarray:
    """The normals after dual edges between faces, across mesh edges of some lengths, have been looked at."""
    count = len(faces)
    vertices = np.zeros((2 * count, 3))
    vertices[count:, 0] = length
    ends = np.stack([np.arange(count), count + np.arange(count)], axis=1)
    flags = np.ones(count, dtype=bool)
    return with_borrowed_normals(normals, DualEdges(np.array(faces), ends, flags, ~flags), vertices)


def test_a_chain_of_slivers_continues_one_face() -> None:
    """Slivers 2 and 3 between the faces 0 and 1: the longest edges lead to the face 0, or to the face 1."""
    normals = np.array([[0, 0, 1.0], [0, 1.0, 0], [0, 0, 0], [0, 0, 0]])
    for between in ([2, 3], [3, 2]):
        edges = [[0, between[0]], between, [between[1], 1]]
        np.testing.assert_array_equal(borrowed(normals, edges, [3.0, 2.0, 1.0])[2:], normals[[0, 0]])
        np.testing.assert_array_equal(borrowed(normals, edges, [1.0, 2.0, 3.0])[2:], normals[[1, 1]])


def test_slivers_without_other_faces_have_no_normal() -> None:
    normals = np.zeros((2, 3))
    np.testing.assert_array_equal(borrowed(normals, [[0, 1]], [1.0]), normals)


def test_normals_that_are_rounding_noise_are_not_reliable() -> None:
    """The height of the face is less than a millionth of the extent of the mesh, which is one."""
    faces = np.array([[0, 1, 2], [0, 1, 3]], dtype=np.int32)
    vertices = np.array([[0, 0, 0], [0.01, 0, 0], [0.005, 5e-7, 0], [0.005, 5e-6, 0]])
    normals, _ = reliable_normals(vertices, faces)
    np.testing.assert_allclose(normals, [[0, 0, 0], [0, 0, 1]])


@pytest.mark.parametrize("name", ["beam", "table", "heat_sink", "gear"])
@pytest.mark.parametrize("at", [0.5, 0.37])
def test_creases_beside_slivers_stay_concave(meshes: dict[str, Mesh], name: str, at: float) -> None:
    mesh = meshes[name]
    surface = build_surface(slivers_at_creases(mesh, at))
    whole = concave_length(build_surface(mesh))
    assert len(surface.faces) > len(mesh.faces)
    np.testing.assert_allclose(concave_length(surface), whole, rtol=1e-5)
    np.testing.assert_allclose(concave_length(refine(surface).surface), whole, rtol=1e-5)


@pytest.mark.parametrize(("name", "parts"), [("beam", 3), ("table", 5), ("gear", 18), ("pipe", 3)])
def test_slivers_along_creases_do_not_change_the_parts(meshes: dict[str, Mesh], name: str, parts: int) -> None:
    mesh = meshes[name]
    assert segment(mesh).labels().max() + 1 == parts
    assert segment(slivers_at_creases(mesh)).labels().max() + 1 == parts
