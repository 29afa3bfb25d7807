"""How likely a person's cut runs along a mesh edge: what a logistic model says from curvature and thickness around it.

Curvature is measured at several scales by normal cycles (Cohen-Steiner and Morvan, Restricted Delaunay triangulations
and normal cycle, SoCG 2003): sums over edges of dihedral angle times length, which do not depend on how the surface is
meshed.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from segcore.affinity.measurements import THICKNESS_RADIUS, Measurements
from segcore.affinity.thickness import smooth_logarithm
from segcore.arrays import FloatArray, IntArray, LongArray, group_sums
from segcore.clean.surface import Surface
from segcore.learned.logistic import signed_log
from segcore.learned.models import learned_models

TENSOR_RADII = (0.0, 0.03, 0.06, 0.12)  # in units of the square root of the total area, as all radii here
THICKNESS_RADII = (0.03, THICKNESS_RADIUS, 0.12)

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
    logs = [
        measured.log_thickness if r == THICKNESS_RADIUS else smooth_logarithm(measured.thickness, patches, r * size)
        for r in THICKNESS_RADII
    ]
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
    ends = surface.vertices[surface.edge_vertices[chosen]]
    features = np.empty((len(ends), len(FEATURES)))
    features[:, 0] = signed_log(measured.edges.dihedral[chosen] / measured.edges.typical_dihedral)
    features[:, 1] = signed_log(measured.k1[chosen])
    features[:, 2] = signed_log(measured.k2[chosen])
    features[:, 3] = np.log1p(measured.bending[chosen])
    features[:, 4] = np.log1p(measured.change[chosen])
    _fill_from_patches(
        features,
        measured.patches.of_face[surface.edge_faces[chosen]],
        measured.edges.across[chosen],
        ends[:, 1] - ends[:, 0],
        fields.tensor,
        fields.mean,
        fields.mean_gradient,
        fields.thickness,
        fields.thickness_gradient,
        fields.confidence,
    )
    return features


@njit(cache=True)
def _fill_from_patches(features, pairs, across, edge, tensor, mean, mean_gradient, thickness, slope, confidence):  # type: ignore[no-untyped-def]
    """The columns from the sixth on: means over the patches at both sides of an edge."""
    scales = tensor.shape[1]
    six = np.empty(6)
    for i in range(len(pairs)):
        f, g = pairs[i, 0], pairs[i, 1]
        row, t, u = features[i], across[i], edge[i]
        length = np.sqrt(u[0] ** 2 + u[1] ** 2 + u[2] ** 2)
        if length > 0.0:
            u /= length
        column = 5
        for s in range(scales):
            for k in range(6):
                six[k] = 0.5 * (tensor[f, s, k] + tensor[g, s, k])
            row[column] = _signed_log(_form(six, t, t))
            row[column + 1] = _signed_log(_form(six, u, u))
            row[column + 2] = np.log1p(abs(_form(six, t, u)))
            column += 3
        for s in range(scales - 1):
            row[column] = np.log1p(_slope(mean_gradient[f, s], mean_gradient[g, s], t))
            before, after = 0.5 * (mean[f, s] + mean[g, s]), 0.5 * (mean[f, s + 1] + mean[g, s + 1])
            row[column + scales - 1] = _signed_log(before - after)
            column += 1
        column += scales - 1
        near, middle, far = 0.5 * (thickness[f] + thickness[g])
        row[column] = middle
        for s in range(3):
            row[column + 1 + s] = np.log1p(_slope(slope[f, s], slope[g, s], t))
        row[column + 4] = np.log1p(_slope(slope[f, 1], slope[g, 1], u))
        row[column + 5] = near - middle
        row[column + 6] = middle - far
        row[column + 7] = 0.5 * (confidence[f] + confidence[g])


@njit(cache=True)
def _form(six, a, b):  # type: ignore[no-untyped-def]
    """The symmetric form (xx, yy, zz, xy, xz, yz) of two vectors."""
    return (
        six[0] * a[0] * b[0]
        + six[1] * a[1] * b[1]
        + six[2] * a[2] * b[2]
        + six[3] * (a[0] * b[1] + a[1] * b[0])
        + six[4] * (a[0] * b[2] + a[2] * b[0])
        + six[5] * (a[1] * b[2] + a[2] * b[1])
    )


@njit(cache=True)
def _slope(one, other, along):  # type: ignore[no-untyped-def]
    """The derivative along a vector, without its sign, of the mean of two gradients."""
    return 0.5 * abs((one[0] + other[0]) * along[0] + (one[1] + other[1]) * along[1] + (one[2] + other[2]) * along[2])


@njit(cache=True)
def _signed_log(x):  # type: ignore[no-untyped-def]
    return np.log1p(x) if x >= 0.0 else -np.log1p(-x)
