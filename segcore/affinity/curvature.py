"""Principal curvatures at the vertices of a mesh.

Rusinkiewicz, Estimating curvatures and their derivatives on triangle meshes, 3DPVT 2004. On every face the second
fundamental form is fitted to the differences of the vertex normals along the three edges. A vertex averages the forms
of its faces, rotated into its own tangent plane and weighted by the part of the face that is nearest to it.
"""

from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from segcore.affinity.frames import tangent_vectors
from segcore.arrays import FloatArray, IntArray
from segcore.jit.decorators import inner_kernel, kernel

_SLIVER = 1e-6  # twice the area over the squared longest edge below which a normal is rounding noise; set by hand
_OPPOSITE = -0.999  # cosine of two normals below which the rotation between them is replaced by a reflection

Vector: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class PrincipalCurvatures:
    """k1 >= k2 at every vertex, in 1 / length; positive where the surface bulges along its normal."""

    k1: FloatArray  # (V,) maximum curvature
    k2: FloatArray  # (V,) minimum curvature, negative in concave places and saddles


def principal_curvatures(vertices: FloatArray, faces: IntArray) -> PrincipalCurvatures:
    """Principal curvatures of consistently oriented faces. O(V + F).

    Parameters
    ----------
    vertices : (V, 3)
    faces : (F, 3), counter-clockwise seen from outside. Slivers are ignored.

    Returns
    -------
    Curvatures of the vertices; 0 at vertices without a face that is not a sliver.
    """
    curvature = _curvature_tensors(vertices, faces)
    e, f, g = curvature.T
    mean, spread = 0.5 * (e + g), np.hypot(0.5 * (e - g), f)
    return PrincipalCurvatures(k1=mean + spread, k2=mean - spread)


class _Stars(NamedTuple):
    """The normal of every vertex, and the area that the vertex stands for."""

    normal: FloatArray  # (V, 3) unit normals
    area: FloatArray  # (V,) of the mixed Voronoi cell


class _Plane(NamedTuple):
    """The plane of a face: two perpendicular unit vectors."""

    t: Vector
    b: Vector


class _Form(NamedTuple):
    """A symmetric form [e f; f g] in a plane."""

    e: float
    f: float
    g: float


@kernel
def _curvature_tensors(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """(V, 3) the entries (e, f, g) of the second fundamental form in a tangent frame of every vertex."""
    count = len(vertices)
    stars = _Stars(np.zeros((count, 3)), np.zeros(count))
    cells = np.zeros((len(faces), 3))
    for i in range(len(faces)):
        _add_normals_and_cells(vertices, faces[i], stars, cells[i])
    for v in range(count):
        _normalize(stars.normal[v])
    tensor = np.zeros((count, 3))
    for i in range(len(faces)):
        _add_face_tensor(vertices, faces[i], stars, cells[i], tensor)
    return tensor


@inner_kernel
def _add_normals_and_cells(vertices: FloatArray, face: IntArray, stars: _Stars, cells: FloatArray) -> None:
    """Add a face to the normals of its vertices (weights of Max 1999) and to their areas (mixed Voronoi cells).

    The areas that its three corners get are written into ``cells`` (3,); they stay 0 for a sliver.
    """
    a, b, c = vertices[face[0]], vertices[face[1]], vertices[face[2]]
    ax, ay, az = c[0] - b[0], c[1] - b[1], c[2] - b[2]
    bx, by, bz = a[0] - c[0], a[1] - c[1], a[2] - c[2]
    cx, cy, cz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    nx, ny, nz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
    double_area = np.sqrt(nx * nx + ny * ny + nz * nz)
    la = ax * ax + ay * ay + az * az
    lb = bx * bx + by * by + bz * bz
    lc = cx * cx + cy * cy + cz * cz
    if double_area <= _SLIVER * max(la, lb, lc):
        return
    weights = (1.0 / (lb * lc), 1.0 / (lc * la), 1.0 / (la * lb))
    for k in range(3):
        v = face[k]
        stars.normal[v, 0] += weights[k] * nx
        stars.normal[v, 1] += weights[k] * ny
        stars.normal[v, 2] += weights[k] * nz
    area = 0.5 * double_area
    # A corner with an obtuse angle gets half of the face and the others get a quarter.
    if la >= lb + lc:
        shares = (0.5 * area, 0.25 * area, 0.25 * area)
    elif lb >= lc + la:
        shares = (0.25 * area, 0.5 * area, 0.25 * area)
    elif lc >= la + lb:
        shares = (0.25 * area, 0.25 * area, 0.5 * area)
    else:
        cot_a = (lb + lc - la) / (2.0 * double_area)
        cot_b = (lc + la - lb) / (2.0 * double_area)
        cot_c = (la + lb - lc) / (2.0 * double_area)
        shares = ((lb * cot_b + lc * cot_c) / 8.0, (lc * cot_c + la * cot_a) / 8.0, (la * cot_a + lb * cot_b) / 8.0)
    for k in range(3):
        cells[k] = shares[k]
        stars.area[face[k]] += shares[k]


@inner_kernel
def _normalize(normal: FloatArray) -> None:
    """Scale a normal (3,) to length 1, in place; a zero vector becomes the z-axis."""
    length = np.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    if length > 0.0:
        normal /= length
    else:
        normal[2] = 1.0


@inner_kernel
def _add_face_tensor(
    vertices: FloatArray, face: IntArray, stars: _Stars, cells: FloatArray, tensor: FloatArray
) -> None:
    """Fit the second fundamental form of a face and add it to the tensors (V, 3) of its vertices."""
    if cells.max() <= 0.0:
        return
    tx, ty, tz = _edge(vertices, face, 0)
    length = np.sqrt(tx * tx + ty * ty + tz * tz)
    tx, ty, tz = tx / length, ty / length, tz / length
    ex, ey, ez = _edge(vertices, face, 1)
    along = ex * tx + ey * ty + ez * tz
    bx, by, bz = ex - along * tx, ey - along * ty, ez - along * tz
    length = np.sqrt(bx * bx + by * by + bz * bz)
    bx, by, bz = bx / length, by / length, bz / length
    # Least squares for (e, f, g): [e f; f g] (du, dv) = (dn.t, dn.b) along each edge.
    suu, suv, svv, re, rf, rg = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        x, y, z = _edge(vertices, face, k)
        du, dv = x * tx + y * ty + z * tz, x * bx + y * by + z * bz
        n0, n1 = stars.normal[face[(k + 1) % 3]], stars.normal[face[(k + 2) % 3]]
        dx, dy, dz = n1[0] - n0[0], n1[1] - n0[1], n1[2] - n0[2]
        nu, nv = dx * tx + dy * ty + dz * tz, dx * bx + dy * by + dz * bz
        suu += du * du
        suv += du * dv
        svv += dv * dv
        re += nu * du
        rf += nu * dv + nv * du
        rg += nv * dv
    # Elimination in [suu suv 0; suv suu+svv suv; 0 suv svv], which is positive definite unless the face is degenerate.
    middle = suu + svv - suv * suv / suu - suv * suv / svv
    f = (rf - suv * re / suu - suv * rg / svv) / middle
    form = _Form((re - suv * f) / suu, f, (rg - suv * f) / svv)
    plane = _Plane((tx, ty, tz), (bx, by, bz))
    for k in range(3):
        v = face[k]
        _add_rotated(form, plane, stars, v, cells[k] / stars.area[v], tensor[v])


@inner_kernel
def _edge(vertices: FloatArray, face: IntArray, k: int) -> Vector:
    """The edge opposite corner k, counter-clockwise."""
    a, b = vertices[face[(k + 1) % 3]], vertices[face[(k + 2) % 3]]
    return b[0] - a[0], b[1] - a[1], b[2] - a[2]


@inner_kernel
def _add_rotated(form: _Form, plane: _Plane, stars: _Stars, vertex: int, weight: float, tensor: FloatArray) -> None:
    """Rotate the frame of a vertex into the plane of a face, and add the form in that frame to the tensor (3,)."""
    (tx, ty, tz), (bx, by, bz) = plane
    e, f, g = form
    normal = stars.normal[vertex]
    u, v = tangent_vectors(normal[0], normal[1], normal[2])
    nx, ny, nz = ty * bz - tz * by, tz * bx - tx * bz, tx * by - ty * bx
    cosine = normal[0] * nx + normal[1] * ny + normal[2] * nz
    if cosine <= _OPPOSITE:
        u1, u2 = -(u[0] * tx + u[1] * ty + u[2] * tz), -(u[0] * bx + u[1] * by + u[2] * bz)
        v1, v2 = -(v[0] * tx + v[1] * ty + v[2] * tz), -(v[0] * bx + v[1] * by + v[2] * bz)
    else:
        # The rotation that takes the vertex normal n to the face normal m maps a vector x of the tangent plane to
        # x - (m.x) (n + m) / (1 + n.m).
        along = (u[0] * nx + u[1] * ny + u[2] * nz) / (1.0 + cosine)
        x, y, z = u[0] - along * (normal[0] + nx), u[1] - along * (normal[1] + ny), u[2] - along * (normal[2] + nz)
        u1, u2 = x * tx + y * ty + z * tz, x * bx + y * by + z * bz
        along = (v[0] * nx + v[1] * ny + v[2] * nz) / (1.0 + cosine)
        x, y, z = v[0] - along * (normal[0] + nx), v[1] - along * (normal[1] + ny), v[2] - along * (normal[2] + nz)
        v1, v2 = x * tx + y * ty + z * tz, x * bx + y * by + z * bz
    tensor[0] += weight * (e * u1 * u1 + 2.0 * f * u1 * u2 + g * u2 * u2)
    tensor[1] += weight * (e * u1 * v1 + f * (u1 * v2 + u2 * v1) + g * u2 * v2)
    tensor[2] += weight * (e * v1 * v1 + 2.0 * f * v1 * v2 + g * v2 * v2)
