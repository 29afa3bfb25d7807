"""The probability that a person cuts along a mesh edge, by a logistic model of curvature and thickness around it."""

from typing import NamedTuple

import numpy as np

from segcore.affinity.measurements import Measurements
from segcore.affinity.patch_fields import TENSOR_RADII, THICKNESS_RADII, PatchFields, patch_fields
from segcore.arrays import FloatArray, IntArray, LongArray
from segcore.clean.edge_geometry import EdgeArrays, across_edge
from segcore.clean.surface import Surface
from segcore.jit.decorators import inner_kernel, kernel
from segcore.learned.logistic import write_probabilities
from segcore.learned.models import learned_models
from segcore.learned.squeezing import squeeze
from segcore.progress import OnPart, report_nothing
from segcore.threads import in_blocks

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

_PLAIN = (_THICKNESS, _EXCESS_NEAR, _EXCESS_FAR, _CONFIDENCE)  # that are no logarithms of numbers of any size

# The first entries of the fields in ``PatchFields.rows``.
_SCALES = len(TENSOR_RADII)
_MEANS = 6 * _SCALES
_GRADIENTS = _MEANS + _SCALES
_LOGARITHMS = _GRADIENTS + 3 * (_SCALES - 1)
_SLOPES = _LOGARITHMS + len(THICKNESS_RADII)
_SHARE = _SLOPES + 3 * len(THICKNESS_RADII)

_PREDICTED = 0.85  # fraction of the processor time of the stage "affinity", as in measurements.py
_AT_ONCE = 512  # edges whose features are in memory at a time: 114 kB, which stay in the cache of a core
_WIDTH = _AT_ONCE + 8  # of their rows: columns whose distance is a power of two would share few lines of the cache


class _Inputs(NamedTuple):
    """What the features of an edge are made from, beside the fields of the patches."""

    arrays: EdgeArrays
    dihedral: FloatArray  # (E,)
    typical_dihedral: float
    half_size: float  # half the square root of the total area
    k1: FloatArray  # (V,)
    k2: FloatArray  # (V,)
    bending: FloatArray  # (E,)
    change: FloatArray  # (E,)
    patch: IntArray  # (F,) of every face


def boundary_probability(surface: Surface, measured: Measurements, on_part: OnPart = report_nothing) -> FloatArray:
    """(E,) the probability that a person's cut runs along each mesh edge.

    Parameters
    ----------
    on_part : called with the fraction of the stage "affinity" that is done.
    """
    model = learned_models().boundary.arrays()
    inputs, fields = _inputs(surface, measured), patch_fields(surface, measured).rows
    probability = np.empty(len(surface.edge_faces))
    in_blocks(_write_boundary_probabilities, len(probability), inputs, fields, model, probability)
    on_part(_PREDICTED)
    return probability


def _inputs(surface: Surface, measured: Measurements) -> _Inputs:
    edges, curvatures = measured.edges, measured.curvatures
    half = 0.5 * measured.size
    return _Inputs(
        EdgeArrays.of(surface),
        edges.dihedral,
        edges.typical_dihedral,
        half,
        curvatures.k1,
        curvatures.k2,
        measured.bending,
        measured.change,
        measured.patches.of_face,
    )


def edge_features(
    surface: Surface, measured: Measurements, fields: PatchFields, chosen: IntArray | LongArray | slice
) -> FloatArray:
    """(N, M) the features of some dual edges, in the order of ``FEATURES``.

    All but the thickness, its excess and the confidence are logarithms, sign(x) log(1 + |x|). Quantities of patches are
    means over the patches at both sides of the edge.

    Parameters
    ----------
    chosen : N of the dual edges.
    """
    edges = np.arange(len(surface.edge_faces))[chosen]
    columns = np.empty((len(FEATURES), len(edges)))
    _write_features(edges, _inputs(surface, measured), fields.rows, columns, np.empty((2, len(edges))))
    return np.ascontiguousarray(columns.T)


@kernel
def _write_boundary_probabilities(start, end, inputs, fields, model, probability):  # type: ignore[no-untyped-def]
    columns, work = np.empty((len(model.mean), _WIDTH)), np.empty((2, _WIDTH))
    for first in range(start, end, _AT_ONCE):
        edges = np.arange(first, min(first + _AT_ONCE, end))
        _write_features(edges, inputs, fields, columns, work)
        write_probabilities(columns, model, probability[first : first + len(edges)])


@kernel
def _write_features(edges, inputs, fields, columns, work):  # type: ignore[no-untyped-def]
    """Write the features of N edges into the first N entries of columns (M, at least N)."""
    mean = np.empty(fields.shape[1])
    f, g = -1, -1
    for i in range(len(edges)):
        one = inputs.patch[inputs.arrays.sides[edges[i], 0]]
        other = inputs.patch[inputs.arrays.sides[edges[i], 1]]
        if one != f or other != g:
            f, g = one, other
            for k in range(len(mean)):
                mean[k] = 0.5 * (fields[f, k] + fields[g, k])
        _write_numbers(i, edges[i], inputs, mean, columns)
    for j in range(len(columns)):
        if j not in _PLAIN:
            squeeze(columns[j, : len(edges)], work)


@inner_kernel
def _write_numbers(i, e, inputs, mean, columns):  # type: ignore[no-untyped-def]
    """Write the features of an edge, before their logarithms are taken, into column entries i.

    Parameters
    ----------
    mean : (50,) the mean of the fields of the patches at its sides, as in ``PatchFields.rows``.
    """
    arrays = inputs.arrays
    a, b = arrays.ends[e, 0], arrays.ends[e, 1]
    columns[_DIHEDRAL, i] = inputs.dihedral[e] / inputs.typical_dihedral
    columns[_K1, i] = inputs.half_size * (inputs.k1[a] + inputs.k1[b])
    columns[_K2, i] = inputs.half_size * (inputs.k2[a] + inputs.k2[b])
    columns[_BENDING, i] = inputs.bending[e]
    columns[_CHANGE, i] = inputs.change[e]
    t = across_edge(arrays, e)
    ux = arrays.vertices[b, 0] - arrays.vertices[a, 0]
    uy = arrays.vertices[b, 1] - arrays.vertices[a, 1]
    uz = arrays.vertices[b, 2] - arrays.vertices[a, 2]
    length = np.sqrt(ux * ux + uy * uy + uz * uz)
    u = (ux / length, uy / length, uz / length) if length > 0.0 else (0.0, 0.0, 0.0)
    for s in range(_SCALES):
        columns[_TENSORS + 3 * s, i] = _value(mean, 6 * s, t, t)
        columns[_TENSORS + 3 * s + 1, i] = _value(mean, 6 * s, u, u)
        columns[_TENSORS + 3 * s + 2, i] = abs(_value(mean, 6 * s, t, u))
    for s in range(_SCALES - 1):
        columns[_MEAN_STEPS + s, i] = abs(_along(mean, _GRADIENTS + 3 * s, t))
        columns[_MEAN_EXCESSES + s, i] = mean[_MEANS + s] - mean[_MEANS + s + 1]
    near, middle, far = mean[_LOGARITHMS], mean[_LOGARITHMS + 1], mean[_LOGARITHMS + 2]
    columns[_THICKNESS, i] = middle
    for s in range(3):
        columns[_THICKNESS_STEPS + s, i] = abs(_along(mean, _SLOPES + 3 * s, t))
    columns[_THICKNESS_SLOPE, i] = abs(_along(mean, _SLOPES + 3, u))
    columns[_EXCESS_NEAR, i] = near - middle
    columns[_EXCESS_FAR, i] = middle - far
    columns[_CONFIDENCE, i] = mean[_SHARE]


@inner_kernel
def _value(numbers, k, a, b):  # type: ignore[no-untyped-def]
    """The value at two vectors of a symmetric bilinear form (xx, yy, zz, xy, xz, yz), numbers k to k + 5."""
    return (
        numbers[k] * a[0] * b[0]
        + numbers[k + 1] * a[1] * b[1]
        + numbers[k + 2] * a[2] * b[2]
        + numbers[k + 3] * (a[0] * b[1] + a[1] * b[0])
        + numbers[k + 4] * (a[0] * b[2] + a[2] * b[0])
        + numbers[k + 5] * (a[1] * b[2] + a[2] * b[1])
    )


@inner_kernel
def _along(numbers, k, direction):  # type: ignore[no-untyped-def]
    """The derivative along a vector of a field with the gradient that numbers k to k + 2 are."""
    return numbers[k] * direction[0] + numbers[k + 1] * direction[1] + numbers[k + 2] * direction[2]
