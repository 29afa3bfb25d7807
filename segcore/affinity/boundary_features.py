"""The probability that a person's cut runs along a mesh edge, by a logistic model of curvature and thickness around it.

Curvature is measured at several scales by normal cycles (Cohen-Steiner and Morvan, Restricted Delaunay triangulations
and normal cycle, SoCG 2003): sums over edges of dihedral angle times length, which do not depend on the meshing.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from segcore.affinity.measurements import MEASURED, THICKNESS_RADIUS, Measurements
from segcore.affinity.thickness import smooth_logarithm
from segcore.arrays import FloatArray, IntArray, LongArray, group_sums
from segcore.clean.surface import Surface
from segcore.learned.logistic import signed_log
from segcore.learned.models import learned_models
from segcore.progress import OnPart, report_nothing

# Radii of smoothing in sqrt(total area), set by hand. The model is trained with them; its card is
# docs/explanation/learned-models.md.
TENSOR_RADII = (0.0, 0.03, 0.06, 0.12)
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

# Columns of single features, and the first columns of groups that follow each other.
_DIHEDRAL = FEATURES.index("dihedral")
_K1 = FEATURES.index("k1")
_K2 = FEATURES.index("k2")
_BENDING = FEATURES.index("bending")
_CHANGE = FEATURES.index("change")
_TENSORS = FEATURES.index(f"across_{TENSOR_RADII[0]}")  # across, along, twist of every radius
_MEAN_STEPS = FEATURES.index(f"mean_step_{TENSOR_RADII[1]}")
_MEAN_EXCESSES = FEATURES.index(f"mean_excess_{TENSOR_RADII[1]}")
_THICKNESS = FEATURES.index("thickness")
_THICKNESS_STEPS = FEATURES.index(f"thickness_step_{THICKNESS_RADII[0]}")
_THICKNESS_SLOPE = FEATURES.index("thickness_slope")
_EXCESS_NEAR = FEATURES.index("thickness_excess_near")
_EXCESS_FAR = FEATURES.index("thickness_excess_far")
_CONFIDENCE = FEATURES.index("confidence")

_PREDICTED = 0.92  # fraction of the processor time of the stage "affinity", as in measurements.py
_BLOCK = 1 << 16  # edges whose features are in memory at a time: 16 MB


class PatchFields(NamedTuple):
    """Curvature and thickness of patches, smoothed over S and T radii."""

    tensor: FloatArray  # (P, S, 6) curvature tensors times sqrt(total area): xx, yy, zz, xy, xz, yz
    mean: FloatArray  # (P, S) half their trace
    mean_gradient: FloatArray  # (P, S - 1, 3) of all but the first
    thickness: FloatArray  # (P, T) logarithms
    thickness_gradient: FloatArray  # (P, T, 3)
    confidence: FloatArray  # (P,)


class _Edges(NamedTuple):
    """Some mesh edges and the patches at their sides."""

    patches: IntArray  # (N, 2)
    across: FloatArray  # (N, 3) unit vectors in the surface, perpendicular to the edge
    along: FloatArray  # (N, 3) from end to end


def boundary_probability(surface: Surface, measured: Measurements, on_part: OnPart = report_nothing) -> FloatArray:
    """(E,) the probability that a person's cut runs along each mesh edge.

    Parameters
    ----------
    on_part : called with the fraction of the stage "affinity" that is done.
    """
    model = learned_models().boundary
    fields = patch_fields(surface, measured)
    probability = np.empty(len(surface.edge_faces))
    for start in range(0, len(probability), _BLOCK):
        block = slice(start, start + _BLOCK)
        probability[block] = model.probability(edge_features(surface, measured, fields, block))
        on_part(MEASURED + (_PREDICTED - MEASURED) * min(1.0, (start + _BLOCK) / len(probability)))
    return probability


def patch_fields(surface: Surface, measured: Measurements) -> PatchFields:
    """Curvature tensors and thickness of the patches at all radii, with the gradients of both."""
    patches = measured.patches
    size = float(np.sqrt(patches.area.sum()))
    raw = _tensors(surface, measured) * size / patches.area[:, None]
    tensors = [raw if r == 0 else patches.smoothed(raw, r * size, patches.area) for r in TENSOR_RADII]
    tensor = np.stack(tensors, axis=1)
    mean = 0.5 * tensor[:, :, :3].sum(axis=2)
    mean_gradient = np.stack([size * patches.gradients(column) for column in mean[:, 1:].T], axis=1)
    logs = [
        measured.log_thickness if r == THICKNESS_RADIUS else smooth_logarithm(measured.thickness, patches, r * size)
        for r in THICKNESS_RADII
    ]
    gradient = np.stack([size * patches.gradients(log) for log in logs], axis=1)
    return PatchFields(tensor, mean, mean_gradient, np.stack(logs, axis=1), gradient, measured.thickness.confidence)


def _tensors(surface: Surface, measured: Measurements) -> FloatArray:
    """(P, 6) the normal cycle of every patch: sums of theta l / 2 over the edges of its faces, bent across the edge."""
    half = 0.5 * measured.edges.dihedral * measured.edges.length
    a, b = measured.patches.of_face[surface.edge_faces].T
    count = len(measured.patches.area)
    x, y, z = measured.edges.across.T
    products = (x * x, y * y, z * z, x * y, x * z, y * z)
    return np.stack([group_sums(a, half * p, count) + group_sums(b, half * p, count) for p in products], axis=1)


def edge_features(
    surface: Surface, measured: Measurements, fields: PatchFields, chosen: IntArray | LongArray | slice
) -> FloatArray:
    """(N, M) the features of some dual edges, in the order of ``FEATURES``.

    All but the thickness, its excess and the confidence are logarithms, signed_log(x) or log(1 + x). Quantities of
    patches are means over the patches at both sides of the edge.

    Parameters
    ----------
    chosen : N of the dual edges.
    """
    ends = surface.vertices[surface.edge_vertices[chosen]]
    features = np.empty((len(ends), len(FEATURES)))
    features[:, _DIHEDRAL] = signed_log(measured.edges.dihedral[chosen] / measured.edges.typical_dihedral)
    features[:, _K1] = signed_log(measured.k1[chosen])
    features[:, _K2] = signed_log(measured.k2[chosen])
    features[:, _BENDING] = np.log1p(measured.bending[chosen])
    features[:, _CHANGE] = np.log1p(measured.change[chosen])
    sides = measured.patches.of_face[surface.edge_faces[chosen]]
    _fill_from_patches(features, _Edges(sides, measured.edges.across[chosen], ends[:, 1] - ends[:, 0]), fields)
    return features


@njit(cache=True)
def _fill_from_patches(features: FloatArray, edges: _Edges, fields: PatchFields) -> None:
    """Write the columns that are made from patches into the features (N, M); the edge vectors become unit vectors."""
    tensor, mean, thickness = fields.tensor, fields.mean, fields.thickness
    step, slope = fields.mean_gradient, fields.thickness_gradient
    scales = tensor.shape[1]
    form = np.empty(6)
    for i in range(len(edges.patches)):
        f, g = edges.patches[i, 0], edges.patches[i, 1]
        row, t, u = features[i], edges.across[i], edges.along[i]
        length = np.sqrt(u[0] ** 2 + u[1] ** 2 + u[2] ** 2)
        if length > 0.0:
            u /= length
        for s in range(scales):
            for k in range(6):
                form[k] = 0.5 * (tensor[f, s, k] + tensor[g, s, k])
            row[_TENSORS + 3 * s] = _signed_log(_value(form, t, t))
            row[_TENSORS + 3 * s + 1] = _signed_log(_value(form, u, u))
            row[_TENSORS + 3 * s + 2] = np.log1p(abs(_value(form, t, u)))
        for s in range(scales - 1):
            row[_MEAN_STEPS + s] = np.log1p(_slope(step[f, s], step[g, s], t))
            finer, coarser = 0.5 * (mean[f, s] + mean[g, s]), 0.5 * (mean[f, s + 1] + mean[g, s + 1])
            row[_MEAN_EXCESSES + s] = _signed_log(finer - coarser)
        near, middle, far = 0.5 * (thickness[f] + thickness[g])
        row[_THICKNESS] = middle
        for s in range(3):
            row[_THICKNESS_STEPS + s] = np.log1p(_slope(slope[f, s], slope[g, s], t))
        row[_THICKNESS_SLOPE] = np.log1p(_slope(slope[f, 1], slope[g, 1], u))
        row[_EXCESS_NEAR] = near - middle
        row[_EXCESS_FAR] = middle - far
        row[_CONFIDENCE] = 0.5 * (fields.confidence[f] + fields.confidence[g])


@njit(cache=True)
def _value(form, a, b):  # type: ignore[no-untyped-def]
    """The value of a symmetric bilinear form (xx, yy, zz, xy, xz, yz) at two vectors."""
    return (
        form[0] * a[0] * b[0]
        + form[1] * a[1] * b[1]
        + form[2] * a[2] * b[2]
        + form[3] * (a[0] * b[1] + a[1] * b[0])
        + form[4] * (a[0] * b[2] + a[2] * b[0])
        + form[5] * (a[1] * b[2] + a[2] * b[1])
    )


@njit(cache=True)
def _slope(one, other, along):  # type: ignore[no-untyped-def]
    """The absolute derivative along a vector of the mean of two gradients."""
    return 0.5 * abs((one[0] + other[0]) * along[0] + (one[1] + other[1]) * along[1] + (one[2] + other[2]) * along[2])


@njit(cache=True)
def _signed_log(x):  # type: ignore[no-untyped-def]
    return np.log1p(x) if x >= 0.0 else -np.log1p(-x)
