import numpy as np
import pytest

from segcore.errors import InvalidMesh
from segcore.mesh import Mesh, face_normals_and_areas

TRIANGLE = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("vertices", "faces", "message"),
    [
        ([[0.0, 0, np.nan], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], "Vertex 0 has a coordinate that is not finite"),
        ([[0.0, 0, 0], [1, 0, 0], [0, np.inf, 0]], [[0, 1, 2]], "Vertex 2"),
        (TRIANGLE, [[0, 1, 3]], r"Face 0 refers to a vertex outside 0\.\.2: \[0, 1, 3\]"),
        (TRIANGLE, [[0, 1, 2], [0, 1, -1]], "Face 1 refers to a vertex outside"),
        (TRIANGLE, np.empty((0, 3), int), "no faces"),
        (TRIANGLE, [[0, 1, 2, 0]], r"shape \(F, 3\), not \(1, 4\)"),
        ([[0.0, 0], [1, 0], [0, 1]], [[0, 1, 2]], r"shape \(V, 3\), not \(3, 2\)"),
        (TRIANGLE, [[0.0, 1, 2]], "Faces must be integers"),
        ([["a", "b", "c"]], [[0, 0, 0]], "Vertices must be real numbers"),
        ([[0.0, 0, 0], [1]], [[0, 1, 2]], "rectangular"),
        ([[0.0, 0, 0], [1e300, 0, 0], [0, 1, 0]], [[0, 1, 2]], "larger than"),
    ],
)
def test_arrays_that_are_no_mesh_are_refused_with_the_first_wrong_entry(vertices, faces, message):
    with pytest.raises(InvalidMesh, match=message):
        Mesh(vertices, faces)


def test_normals_and_areas_of_a_right_triangle():
    normals, areas = face_normals_and_areas(np.array([TRIANGLE, [[0.0, 0, 0]] * 3]))
    np.testing.assert_array_equal(normals, [[0, 0, 1], [0, 0, 0]])
    np.testing.assert_array_equal(areas, [0.5, 0])


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e300])
def test_vertices_that_no_face_uses_count_for_nothing_and_keep_their_place(bad):
    mesh = Mesh([[bad, 0, 0], *TRIANGLE, [0, 0, bad]], [[2, 3, 1]], notes=("A note.",))
    assert mesh.vertices.tolist() == [TRIANGLE[1], *TRIANGLE, TRIANGLE[1]]
    assert mesh.notes == (
        "A note.",
        "2 vertices that no face uses are not finite or too far away: they were moved to vertex 2.",
    )
    assert [side.tolist() for side in mesh.bounds] == [[0, 0, 0], [1, 1, 0]]


def test_a_far_vertex_that_no_face_uses_stays_and_is_outside_the_bounds():
    mesh = Mesh([*TRIANGLE, [1e9, 0, 0]], [[0, 1, 2]])
    assert mesh.vertices[3].tolist() == [1e9, 0, 0]
    assert mesh.notes == ()
    assert [side.tolist() for side in mesh.bounds] == [[0, 0, 0], [1, 1, 0]]
