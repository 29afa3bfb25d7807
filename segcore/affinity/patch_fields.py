"""Curvature and thickness of patches at several scales.

Curvature is measured by normal cycles (Cohen-Steiner and Morvan, Restricted Delaunay triangulations and normal cycle,
SoCG 2003): sums over edges of dihedral angle times length, which do not depend on the meshing.
"""

from typing import NamedTuple

import numpy as np

from segcore.affinity.measurements import THICKNESS_RADIUS, Measurements
from segcore.affinity.thickness import smooth_logarithm
from segcore.arrays import FloatArray
from segcore.clean.edge_geometry import EdgeArrays, across_edge
from segcore.clean.surface import Surface
from segcore.jit.decorators import kernel
from segcore.threads import sums_of_blocks

# Radii of smoothing in sqrt(total area), set by hand. The model is trained with them; its card is
# docs/explanation/learned-models.md.
TENSOR_RADII = (0.0, 0.03, 0.06, 0.12)
THICKNESS_RADII = (0.03, THICKNESS_RADIUS, 0.12)


class PatchFields(NamedTuple):
    """Curvature and thickness of patches, smoothed over S and T radii."""

    tensor: FloatArray  # (P, S, 6) curvature tensors times sqrt(total area): xx, yy, zz, xy, xz, yz
    mean: FloatArray  # (P, S) half their trace
    mean_gradient: FloatArray  # (P, S - 1, 3) of all but the first
    thickness: FloatArray  # (P, T) logarithms
    thickness_gradient: FloatArray  # (P, T, 3)
    confidence: FloatArray  # (P,)
    rows: FloatArray  # (P, 50) all of these, those of a patch in a row; the other arrays are views of it

    @classmethod
    def empty(cls, count: int) -> "PatchFields":
        """Room for the fields of some patches."""
        scales, radii = len(TENSOR_RADII), len(THICKNESS_RADII)
        shapes = (scales, 6), (scales,), (scales - 1, 3), (radii,), (radii, 3), ()
        end = np.cumsum([int(np.prod(shape)) for shape in shapes]).tolist()
        rows = np.empty((count, end[-1]))
        parts = np.split(rows, end[:-1], axis=1)
        return cls._make([*(part.reshape(count, *shape) for part, shape in zip(parts, shapes, strict=True)), rows])


def patch_fields(surface: Surface, measured: Measurements) -> PatchFields:
    """Curvature tensors and thickness of the patches at all radii, with the gradients of both."""
    patches = measured.patches
    size = float(np.sqrt(patches.area.sum()))
    raw = _tensors(surface, measured) * size / patches.area[:, None]
    fields = PatchFields.empty(len(raw))
    for s, r in enumerate(TENSOR_RADII):
        fields.tensor[:, s] = raw if r == 0 else patches.smoothed(raw, r * size, patches.area)
    fields.mean[:] = 0.5 * fields.tensor[:, :, :3].sum(axis=2)
    for s, column in enumerate(fields.mean[:, 1:].T):
        fields.mean_gradient[:, s] = size * patches.gradients(column)
    for s, r in enumerate(THICKNESS_RADII):
        is_known = r == THICKNESS_RADIUS
        log = measured.log_thickness if is_known else smooth_logarithm(measured.thickness, patches, r * size)
        fields.thickness[:, s] = log
        fields.thickness_gradient[:, s] = size * patches.gradients(log)
    fields.confidence[:] = measured.thickness.confidence
    return fields


def _tensors(surface: Surface, measured: Measurements) -> FloatArray:
    """(P, 6) the normal cycle of every patch: sums of theta l / 2 over the edges of its faces, bent across the edge."""
    edges, count = measured.edges, len(measured.patches.area)
    arrays = EdgeArrays.of(surface), edges.dihedral, edges.length, measured.patches.of_face, count
    if len(edges.length) == 0:
        return np.zeros((count, 6))
    return sums_of_blocks(_patch_tensors, len(edges.length), *arrays, groups=count)


@kernel
def _patch_tensors(start, end, arrays, dihedral, length, of_face, count):  # type: ignore[no-untyped-def]
    tensors = np.zeros((count, 6))
    for e in range(start, end):
        half = 0.5 * dihedral[e] * length[e]
        x, y, z = across_edge(arrays, e)
        for side in range(2):
            tensor = tensors[of_face[arrays.sides[e, side]]]
            tensor[0] += half * (x * x)
            tensor[1] += half * (y * y)
            tensor[2] += half * (z * z)
            tensor[3] += half * (x * y)
            tensor[4] += half * (x * z)
            tensor[5] += half * (y * z)
    return tensors
