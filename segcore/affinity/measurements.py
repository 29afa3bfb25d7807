"""Measurements on a surface: bending along its edges, and the change of thickness across them."""

from dataclasses import dataclass

import numpy as np

from segcore.affinity.curvature import PrincipalCurvatures, principal_curvatures
from segcore.affinity.patches import Patches, patches_of
from segcore.affinity.thickness import Thickness, patch_thickness, smooth_logarithm
from segcore.arrays import FloatArray
from segcore.clean.edge_geometry import EdgeArrays, EdgeGeometry, across_edge
from segcore.clean.surface import Surface
from segcore.jit.decorators import kernel
from segcore.progress import OnPart, report_nothing
from segcore.threads import in_blocks, meanwhile

# The sources of these numbers are in docs/algorithm.md, "Constants" of section 2.
_CURVATURE_SCALE = 8.0  # concave minimum curvature, times sqrt(total area), that bends as much as a mean dihedral angle
THICKNESS_RADIUS = 0.06  # of the smoothing of the thickness, in sqrt(total area)
_LARGEST_CHANGE = 3.0
_LOWEST_GUARD = 0.03  # affinity at the deepest concavity when patches are made, as that of the edge weights
# Fractions of the processor time of the stage "affinity", measured on a dumbbell of 2,000,000 faces.
_CURVED, _PATCHED, _MEASURED = 0.27, 0.45, 0.65


@dataclass(frozen=True, slots=True, eq=False)
class Measurements:
    """Dimensionless quantities on the dual edges of a surface, and on its patches."""

    edges: EdgeGeometry
    size: float  # sqrt(total area)
    curvatures: PrincipalCurvatures  # of the vertices
    bending: FloatArray  # (E,) concave bending, see ``measure``
    change: FloatArray  # (E,) change of thickness across the edge, 0 to 3
    patches: Patches
    thickness: Thickness
    log_thickness: FloatArray  # (P,) its logarithm, smoothed over 0.06 sqrt(A)


def measure(surface: Surface, seed: int, on_part: OnPart = report_nothing) -> Measurements:
    """Measure a surface.

    The concave bending of an edge is x1 + x2 / 8 with x1 = max(0, -theta) / mean |theta| and x2 = sqrt(A) max(0, -k2),
    where theta is the dihedral angle (0 where flat, negative where concave), the mean is weighted by edge length, k2 is
    the minimum curvature averaged over the ends of the edge, and A is the total area.

    The change of thickness is x3 = min(3, 0.06 sqrt(A) c |dt|), where dt is the derivative across the edge of the
    logarithm of the shape diameter, smoothed over 0.06 sqrt(A), and c is the share of rays that met the other side from
    inside. If the surface is open or inside out, c and with it x3 is 0.

    Parameters
    ----------
    seed : of the random order in which faces are merged into patches.
    on_part : called with the fraction of the stage "affinity" that is done.
    """
    curved = meanwhile(principal_curvatures, surface.vertices, surface.faces)
    edges = EdgeGeometry.of(surface)
    size = float(np.sqrt(surface.areas.sum()))
    curvatures = curved()
    bending = np.empty(len(edges.length))
    bend = edges.typical_dihedral, 0.5 * size, surface.edge_vertices
    in_blocks(_write_bending, len(bending), edges.dihedral, *bend, curvatures.k2, bending)
    guard = _LOWEST_GUARD + (1.0 - _LOWEST_GUARD) * np.exp(-bending)
    on_part(_CURVED)
    patches = patches_of(surface, guard, edges.positive_length, np.random.default_rng(seed))
    on_part(_PATCHED)
    thickness = patch_thickness(surface, patches)
    log = smooth_logarithm(thickness, patches, THICKNESS_RADIUS * size)
    slope = patches.gradients(log) * (THICKNESS_RADIUS * size * thickness.confidence)[:, None]
    change = np.empty(len(bending))
    in_blocks(_write_change, len(change), EdgeArrays.of(surface), patches.of_face, slope, change)
    on_part(_MEASURED)
    return Measurements(edges, size, curvatures, bending, change, patches, thickness, log)


@kernel
def _write_bending(start, end, dihedral, typical, half_size, ends, k2, bending):  # type: ignore[no-untyped-def]
    for e in range(start, end):
        lowest = half_size * (k2[ends[e, 0]] + k2[ends[e, 1]])
        bending[e] = max(0.0, -dihedral[e]) / typical + max(0.0, -lowest) / _CURVATURE_SCALE


@kernel
def _write_change(start, end, arrays, of_face, slope, change):  # type: ignore[no-untyped-def]
    """Write the derivative across every edge, from the slopes (P, 3) of the patches at its sides."""
    for e in range(start, end):
        x, y, z = across_edge(arrays, e)
        one, other = slope[of_face[arrays.sides[e, 0]]], slope[of_face[arrays.sides[e, 1]]]
        along = 0.5 * (one[0] + other[0]) * x + 0.5 * (one[1] + other[1]) * y + 0.5 * (one[2] + other[2]) * z
        change[e] = min(_LARGEST_CHANGE, abs(along))
