"""Legal meshes that are hard to clean and to measure: the work on them must grow as on smooth ones."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from segcore.arrays import FloatArray

if TYPE_CHECKING:
    from segcore.mesh import Mesh

_FACES_OF_BOW_TIE = 2


def torus_of_random_places(faces: int) -> Mesh:
    """A closed surface that crosses itself everywhere: every vertex is at a random place in a cube."""
    side = round((faces / 2) ** 0.5)
    return _grid(np.random.default_rng(0).random((side * side, 3)), side, closed=True)


def white_noise(faces: int) -> Mesh:
    """A height field whose heights are independent and several times as large as its steps."""
    side = round((faces / 2) ** 0.5) + 1
    rng = np.random.default_rng(0)
    x, y = np.divmod(np.arange(side * side), side)
    return _grid(np.column_stack([x, y, 5 * rng.normal(size=side * side)]), side, closed=False)


def complete_graph(faces: int) -> Mesh:
    """Every vertex is joined to every other: a face for each pair of vertices, with a random third one."""
    from segcore.mesh import Mesh

    count = round((2 * faces) ** 0.5)
    rng = np.random.default_rng(0)
    a, b = np.triu_indices(count, 1)
    corners = np.stack([a, b, rng.integers(0, count, len(a))], axis=1)
    proper = (corners[:, 2] != corners[:, 0]) & (corners[:, 2] != corners[:, 1])
    return Mesh(rng.normal(size=(count, 3)), corners[proper])


def bow_ties(faces: int) -> Mesh:
    """Pairs of faces that share one vertex."""
    one = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, -1, 0]])
    return _scattered(one, np.array([[0, 1, 2], [0, 3, 4]]), faces // _FACES_OF_BOW_TIE)


def single_faces(faces: int) -> Mesh:
    """Components of one face."""
    return _scattered(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]), faces)


def one_edge(faces: int) -> Mesh:
    """Faces that all have the same edge."""
    from segcore.mesh import Mesh

    ends = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    third = 2 + np.arange(faces)
    return Mesh(np.vstack([ends, _circle(faces)]), np.stack([0 * third, 0 * third + 1, third], axis=1))


def fan(faces: int) -> Mesh:
    """A cone: all faces meet at one vertex."""
    from segcore.mesh import Mesh

    rim = 1 + np.arange(faces)
    corners = np.stack([0 * rim, rim, np.roll(rim, -1)], axis=1)
    return Mesh(np.vstack([[[0.0, 0.0, 1.0]], _circle(faces)]), corners)


# The meshes of the table, with their numbers of faces.
HARD_SHAPES: dict[str, tuple[Callable[[int], Mesh], int]] = {
    "crosses itself": (torus_of_random_places, 330_000),
    "complete graph": (complete_graph, 330_000),
    "bow ties": (bow_ties, 300_000),
    "single faces": (single_faces, 500_000),
    "one edge": (one_edge, 200_000),
    "fan": (fan, 200_000),
    "white noise": (white_noise, 1_300_000),
}


def _circle(count: int) -> FloatArray:
    angle = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle), np.zeros(count)], axis=1)


def _scattered(vertices: FloatArray, faces: np.ndarray, count: int) -> Mesh:
    """Copies of a small mesh at random places, far enough apart not to touch mostly."""
    from segcore.mesh import Mesh

    places = 1000.0 * np.random.default_rng(0).random((count, 1, 3))
    copies = np.arange(count)[:, None, None] * len(vertices)
    return Mesh((places + vertices).reshape(-1, 3), (faces + copies).reshape(-1, 3))


def _grid(vertices: FloatArray, side: int, *, closed: bool) -> Mesh:
    """Two faces for every square of a grid of side x side vertices, which may be closed to a torus."""
    from segcore.mesh import Mesh

    number = np.arange(side * side).reshape(side, side)
    if closed:
        number = np.pad(number, (0, 1), mode="wrap")
    here, right, below, across = number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]
    faces = [np.stack([here, below, right], -1), np.stack([right, below, across], -1)]
    return Mesh(vertices, np.concatenate(faces).reshape(-1, 3))
