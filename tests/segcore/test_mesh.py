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
