import numpy as np

from segcore import shapes
from segcore.clean.welding import weld
from segcore.mesh import Mesh
from segcore.report import mesh_report

BALL = shapes.icosphere(2)


def test_a_face_loses_a_corner_only_if_two_corners_are_at_exactly_the_same_place() -> None:
    tiny = np.array([[0, 0, 0], [1, 0, 0], [1, 1e-8, 0], [0, 1, 0], [1, 1e-8, 0], [2, 2, 2]])
    faces = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    assert weld(tiny, faces).tolist() == [0, 1, 2, 3, 2, 5]


def test_a_mesh_without_borders_is_welded_exactly_only() -> None:
    near = np.vstack([BALL.vertices, BALL.vertices * (1 + 1e-9)])
    faces = np.vstack([BALL.faces, BALL.faces[:, ::-1] + len(BALL.vertices)])
    assert weld(near, faces).tolist() == list(range(len(near)))
    assert mesh_report(Mesh(near, faces)).components == 2
