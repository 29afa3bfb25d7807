"""Polygons become triangles: fans, and ears if they are concave."""

import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.ply import ply
from helpers.files.polygon_soups import read
from helpers.files.samples import INDICES, XYZ
from segcore.io.polygons import Polygons, fan_corners, triangle_corners
from segcore.mesh import Mesh, face_normals_and_areas

ARROW = [(0.0, 0.0), (2.0, 2.0), (0.0, 1.0), (-2.0, 2.0)]  # only the diagonal from its third corner is inside
COMB = [(0, 0), (5, 0), (5, 4), (4, 4), (4, 1), (3, 1), (3, 4), (2, 4), (2, 1), (1, 1), (1, 4), (0, 4)]  # area 14
BRIDGED = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)]  # a hole in a square
TILTS = [np.eye(3), np.diag([1.0, -1.0, -1.0]), np.linalg.qr(np.array([[1.0, 2, 3], [4, 5, 6], [7, 8, 10]]))[0]]


def in_space(points: list[tuple[float, float]], tilt: np.ndarray | None = None) -> np.ndarray:
    flat = np.column_stack([np.array(points, dtype=np.float64), np.zeros(len(points))])
    return flat if tilt is None else flat @ tilt


def one_polygon(size: int) -> Polygons:
    return Polygons(np.arange(size), np.array([size]))


def areas(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Signed areas by the normal of the polygon, which is that of all faces together."""
    corners = vertices[faces]
    cross = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = cross.sum(axis=0)
    return cross @ total / np.linalg.norm(total)


def comb(teeth: int) -> list[tuple[float, float]]:
    """Area 2 teeth - 1 + 3 teeth."""
    upper = [(x, y) for k in range(teeth) for x, y in ((2 * k, 4), (2 * k + 1, 4), (2 * k + 1, 1), (2 * k + 2, 1))]
    return [(float(x), float(y)) for x, y in [(0, 0), *upper[:-2], (2 * teeth - 1, 0)][::-1]]


@pytest.mark.parametrize("turn", range(12))
@pytest.mark.parametrize("tilt", TILTS)
@pytest.mark.parametrize(("polygon", "area"), [(ARROW, 2), (COMB, 14), (BRIDGED, 12), (comb(40), 199)])
def test_the_triangles_of_a_concave_polygon_cover_it_once(
    polygon: list[tuple[float, float]], area: float, tilt: np.ndarray, turn: int
) -> None:
    turn %= len(polygon)
    vertices = in_space(polygon[turn:] + polygon[:turn], tilt)
    faces, fans = triangle_corners(vertices, one_polygon(len(polygon)))
    assert len(faces) == len(polygon) - 2
    assert fans == 0
    assert (areas(vertices, faces) > 0).all()
    assert areas(vertices, faces).sum() == pytest.approx(area)
    assert np.unique(faces).tolist() == list(range(len(polygon)))


@given(st.integers(4, 40), st.randoms(use_true_random=False), st.sampled_from(TILTS))
def test_any_star_is_covered_once(size: int, random: object, tilt: np.ndarray) -> None:
    angle = np.arange(size) * 2 * np.pi / size
    radius = np.array([random.uniform(0.05, 1) for _ in range(size)])  # type: ignore[attr-defined]
    vertices = in_space(list(zip(radius * np.cos(angle), radius * np.sin(angle), strict=True)), tilt)
    faces, _ = triangle_corners(vertices, one_polygon(size))
    area = 0.5 * (radius * np.roll(radius, 1)).sum() * np.sin(2 * np.pi / size)
    assert (areas(vertices, faces) > -1e-6 * area).all()
    assert areas(vertices, faces).sum() == pytest.approx(area)


@given(st.lists(st.floats(0, 6.28), min_size=4, max_size=12, unique=True), st.sampled_from(TILTS))
def test_a_convex_polygon_stays_a_fan(angles: list[float], tilt: np.ndarray) -> None:
    vertices = in_space([(np.cos(angle), np.sin(angle)) for angle in sorted(angles)], tilt)
    polygons = one_polygon(len(angles))
    assert triangle_corners(vertices, polygons)[0].tolist() == fan_corners(polygons.sizes).tolist()


@pytest.mark.parametrize(
    "points",
    [
        [(0, 0), (1, 0), (2, 0), (3, 0)],
        [(0, 0)] * 5,
        [(0, 0), (1, 1), (1, 0), (0, 1)],
        [(0, 0), (3, 3), (3, 0), (0, 1)],
        [(0, 0), (1, 0), (1, 1), (1, 1), (0, 1)],
        [(0, 0), (1, 0), (2, 0), (2, 1), (0, 1)],
        [(0, 0), (np.inf, 0), (1, 1), (0.5, 0.5)],
        [(0, 0), (np.nan, 0), (1, 1), (0.5, 0.5)],
        [(0, 0), (1e-200, 0), (0, 1e-320), (0, 0)],
    ],
    ids=["a line", "a point", "a bow", "a lopsided bow", "repeated", "straight", "infinite", "not a number", "tiny"],
)
def test_a_degenerate_polygon_stays_a_fan(points: list[tuple[float, float]]) -> None:
    polygons = one_polygon(len(points))
    with np.errstate(all="ignore"):
        faces, _ = triangle_corners(in_space(points), polygons)
    assert faces.tolist() == fan_corners(polygons.sizes).tolist()


@pytest.mark.parametrize("factor", [1e-90, 1e-3, 1e90])
def test_the_size_and_the_place_of_a_polygon_do_not_matter(factor: float) -> None:
    polygons = one_polygon(len(COMB))
    wanted = triangle_corners(in_space(COMB), polygons)[0].tolist()
    assert triangle_corners(in_space(COMB) * factor, polygons)[0].tolist() == wanted
    assert triangle_corners((in_space(COMB) + np.array([5e5, 4.5e6, 100])) * factor, polygons)[0].tolist() == wanted


def test_a_polygon_of_many_corners_takes_bounded_time_and_stays_a_fan_beyond() -> None:
    polygon = in_space(comb(5_000))
    polygons = one_polygon(len(polygon))
    start = time.perf_counter()
    faces, fans = triangle_corners(polygon, polygons)
    assert time.perf_counter() - start < 20
    assert areas(polygon, faces).sum() == pytest.approx(5 * 5_000 - 1)
    assert (areas(polygon, faces) > 0).all()
    assert fans == 0
    faces, fans = triangle_corners(polygon, polygons, steps=1_000)
    assert faces.tolist() == fan_corners(polygons.sizes).tolist()
    assert fans == 1


def obj() -> bytes:
    lines = [f"v {x} {y} 0" for x, y in COMB] + ["f 1 2 3", "f " + " ".join(str(i + 1) for i in range(12)), "f 1 2 3"]
    return "\n".join(lines).encode()


def off() -> bytes:
    lines = ["OFF", "12 3 0", *(f"{x} {y} 0" for x, y in COMB), "3 0 1 2"]
    return "\n".join([*lines, "12 " + " ".join(map(str, range(12))), "3 0 1 2"]).encode()


def ply_file() -> bytes:
    rows = [[float(x), float(y), 0.0] for x, y in COMB]
    return ply("ascii", [("vertex", XYZ, rows), ("face", INDICES, [[[0, 1, 2]], [[*range(12)]], [[0, 1, 2]]])])


@pytest.mark.parametrize("data", [obj(), off(), ply_file()], ids=["obj", "off", "ply"])
def test_every_format_with_polygons_clips_them_and_keeps_their_order(data: bytes) -> None:
    mesh: Mesh = read(data)
    assert len(mesh.vertices) == len(COMB)
    assert mesh.source_polygon is not None
    assert mesh.source_polygon.tolist() == [0, *[1] * 10, 2]
    assert face_normals_and_areas(mesh.corners)[1][1:-1].sum() == pytest.approx(14)


def test_attributes_follow_the_corners_of_a_concave_polygon() -> None:
    """The second face has texture coordinates of its own, so that its corners have further rows."""
    lines = [f"v {x} {y} 0\nvt {x} {y}\nvt {x + 100} {y}" for x, y in COMB]
    faces = [" ".join(f"{i + 1}/{2 * i + 1 + face}" for i in range(12)) for face in (0, 1)]
    mesh = read("\n".join([*lines, *(f"f {face}" for face in faces)]).encode(), appearance=True)
    look = mesh.appearance
    assert look is not None
    assert look.uvs is not None
    assert look.corners is not None
    u = look.uvs[look.corners][:, :, 0] - mesh.corners[:, :, 0]
    assert u[:10].tolist() == [[0] * 3] * 10
    assert u[10:].tolist() == [[100] * 3] * 10
