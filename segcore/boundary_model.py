"""How likely a person's cut runs along a mesh edge: what a logistic model says from curvature and thickness around it.

Curvature is measured at several scales by normal cycles (Cohen-Steiner and Morvan, Restricted Delaunay triangulations
and normal cycle, SoCG 2003): sums over edges of dihedral angle times length, which do not depend on how the surface is
meshed.
"""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray, IntArray, LongArray, group_sums
from segcore.learned import learned_models
from segcore.logistic import signed_log
from segcore.measurements import Measurements
from segcore.surface import Surface
from segcore.thickness import smooth_logarithm

TENSOR_RADII = (0.0, 0.03, 0.06, 0.12)  # in units of the square root of the total area, as all radii here
THICKNESS_RADII = (0.03, 0.06, 0.12)

FEATURES = (
    "dihedral",
    "k1",
    "k2",
    "bending",
    "change",
    *(f"{name}_{radius}" for radius in TENSOR_RADII for name in ("across", "along", "twist")),
    *(f"mean_step_{radius}" for radius in TENSOR_RADII[1:]),
    *(f"mean_excess_{radius}" for radius in TENSOR_RADII[1:]),
    "thickness",
    *(f"thickness_step_{radius}" for radius in THICKNESS_RADII),
    "thickness_slope",
    "thickness_excess_near",
    "thickness_excess_far",
    "confidence",
)


_BLOCK = 1 << 16  # edges whose features are in memory at a time


@dataclass(frozen=True, slots=True, eq=False)
class PatchFields:
    """What is known of patches, smoothed over several radii."""

    tensor: FloatArray  # (P, S, 6) curvature tensors times the square root of the total area: xx, yy, zz, xy, xz, yz
    mean: FloatArray  # (P, S) half their trace
    mean_gradient: FloatArray  # (P, S - 1, 3)
    thickness: FloatArray  # (P, T) logarithms
    thickness_gradient: FloatArray  # (P, T, 3)
    confidence: FloatArray  # (P,)


def boundary_probability(surface: Surface, measured: Measurements) -> FloatArray:
    """(E,) the chance that a person's cut runs along every mesh edge."""
    model = learned_models().boundary
    fields = patch_fields(surface, measured)
    chance = np.empty(len(surface.edge_faces))
    for start in range(0, len(chance), _BLOCK):
        block = slice(start, start + _BLOCK)
        chance[block] = model.probability(edge_features(surface, measured, fields, block))
    return chance


def patch_fields(surface: Surface, measured: Measurements) -> PatchFields:
    patches = measured.patches
    size = float(np.sqrt(patches.area.sum()))
    raw = _tensors(surface, measured) * size / patches.area[:, None]
    tensor = np.stack([raw if r == 0 else patches.smoothed(raw, r * size) for r in TENSOR_RADII], axis=1)
    mean = 0.5 * tensor[:, :, :3].sum(axis=2)
    mean_gradient = np.stack([size * patches.gradients(column) for column in mean[:, 1:].T], axis=1)
    logs = [smooth_logarithm(measured.thickness, patches, r * size) for r in THICKNESS_RADII]
    gradient = np.stack([size * patches.gradients(log) for log in logs], axis=1)
    return PatchFields(tensor, mean, mean_gradient, np.stack(logs, axis=1), gradient, measured.thickness.confidence)


def _tensors(surface: Surface, measured: Measurements) -> FloatArray:
    """(P, 6): the normal cycle of every patch; the bending of an edge is across it."""
    half = 0.5 * measured.edges.dihedral * measured.edges.length
    a, b = measured.patches.of_face[surface.edge_faces].T
    count = len(measured.patches.area)
    x, y, z = measured.edges.across.T
    products = (x * x, y * y, z * z, x * y, x * z, y * z)
    return np.stack([group_sums(a, half * p, count) + group_sums(b, half * p, count) for p in products], axis=1)


def edge_features(
    surface: Surface, measured: Measurements, fields: PatchFields, chosen: IntArray | LongArray | slice
) -> FloatArray:
    """(N, M): the features of some dual edges, in the order of ``FEATURES``."""
    f, g = measured.patches.of_face[surface.edge_faces[chosen]].T
    t = measured.edges.across[chosen]
    ends = surface.vertices[surface.edge_vertices[chosen]]
    u = ends[:, 1] - ends[:, 0]
    u /= np.maximum(np.linalg.norm(u, axis=1, keepdims=True), np.finfo(float).tiny)

    def both(field: FloatArray) -> FloatArray:
        return 0.5 * (field[f] + field[g])

    columns = [
        signed_log(measured.edges.dihedral[chosen] / measured.edges.typical_dihedral),
        signed_log(measured.k1[chosen]),
        signed_log(measured.k2[chosen]),
        np.log1p(measured.bending[chosen]),
        np.log1p(measured.change[chosen]),
    ]
    tensor, mean = both(fields.tensor), both(fields.mean)
    for scale in range(len(TENSOR_RADII)):
        six = tensor[:, scale]
        columns += [signed_log(_form(six, t, t)), signed_log(_form(six, u, u)), np.log1p(np.abs(_form(six, t, u)))]
    steps = np.abs(np.einsum("nsk,nk->ns", both(fields.mean_gradient), t))
    columns += list(np.log1p(steps).T)
    columns += list(signed_log(mean[:, :-1] - mean[:, 1:]).T)
    log = both(fields.thickness)
    slope = both(fields.thickness_gradient)
    columns.append(log[:, 1])
    columns += list(np.log1p(np.abs(np.einsum("nsk,nk->ns", slope, t))).T)
    columns.append(np.log1p(np.abs(np.einsum("nk,nk->n", slope[:, 1], u))))
    columns += [log[:, 0] - log[:, 1], log[:, 1] - log[:, 2], both(fields.confidence)]
    return np.stack(columns, axis=1)


def _form(six: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    xx, yy, zz, xy, xz, yz = six.T
    value: FloatArray = (
        xx * a[:, 0] * b[:, 0]
        + yy * a[:, 1] * b[:, 1]
        + zz * a[:, 2] * b[:, 2]
        + xy * (a[:, 0] * b[:, 1] + a[:, 1] * b[:, 0])
        + xz * (a[:, 0] * b[:, 2] + a[:, 2] * b[:, 0])
        + yz * (a[:, 1] * b[:, 2] + a[:, 2] * b[:, 1])
    )
    return value
