"""Polygon soups that Hypothesis makes, and what every reader must make of them."""

import io
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st

from segcore.errors import CleaveError
from segcore.io import ReadLimits, read_mesh
from segcore.mesh import Mesh

Point = tuple[float, float, float]
Triangle = tuple[int, int, int]


@dataclass(frozen=True)
class Soup:
    """The content of a mesh file before it is written in some way."""

    vertices: list[Point]
    polygons: list[list[int]]

    @property
    def triangles(self) -> list[Triangle]:
        """The fans of the polygons, in order."""
        return [(p[0], p[i], p[i + 1]) for p in self.polygons for i in range(1, len(p) - 1)]

    @property
    def source_polygons(self) -> list[int]:
        return [number for number, p in enumerate(self.polygons) for _ in range(len(p) - 2)]


coordinates = st.floats(-1e6, 1e6, width=32, allow_subnormal=False)


@st.composite
def soups(draw: st.DrawFn, largest_polygon: int = 6) -> Soup:
    vertices = draw(st.lists(st.tuples(coordinates, coordinates, coordinates), min_size=1, max_size=12))
    index = st.integers(0, len(vertices) - 1)
    polygons = draw(st.lists(st.lists(index, min_size=3, max_size=largest_polygon), min_size=1, max_size=12))
    return Soup(vertices, polygons)


def triangle_soups() -> st.SearchStrategy[Soup]:
    return soups(largest_polygon=3)


def read(
    data: bytes,
    format: str | None = None,  # noqa: A002
    limits: ReadLimits | None = None,
    appearance: bool = False,
) -> Mesh:
    return read_mesh(io.BytesIO(data), format, limits=limits, appearance=appearance)


def read_or_none(data: bytes, format: str | None = None, appearance: bool = False) -> Mesh | None:  # noqa: A002
    """None where the bytes are refused as they should be: with an error of ours, and with no other."""
    try:
        return read(data, format, appearance=appearance)
    except CleaveError:
        return None


def assert_is_soup(mesh: Mesh, soup: Soup) -> None:
    """The mesh has every vertex, bit for bit, and every face of the soup in its place."""
    assert mesh.vertices.tolist() == [list(vertex) for vertex in soup.vertices]
    assert mesh.faces.tolist() == [list(triangle) for triangle in soup.triangles]
    assert source_polygons(mesh) == soup.source_polygons


def source_polygons(mesh: Mesh) -> list[int]:
    if mesh.source_polygon is None:
        return list(range(len(mesh.faces)))
    assert mesh.source_polygon.dtype == np.int32
    polygons: list[int] = mesh.source_polygon.tolist()
    return polygons


def assert_same_mesh(mesh: Mesh, vertices: list[Point], faces: list[Triangle]) -> None:
    assert mesh.vertices.tolist() == [list(vertex) for vertex in vertices]
    assert mesh.faces.tolist() == [list(face) for face in faces]
