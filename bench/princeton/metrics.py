"""The four metrics of the Princeton Segmentation Benchmark, with the conventions of the benchmark's own program.

All of them are 0 for equal segmentations, and lower is better. Below, C_i are the segments of the candidate, R_j those
of the reference, F the number of faces, |.| an area as a share of the whole surface and #. a number of faces.

The values of the program differ from a literal reading of the paper in three places, all kept here so that published
numbers can be compared with ours:

- the Rand index divides by F (F - 2), not by F (F - 1);
- the consistency error takes its refinement errors from areas but averages them over faces, unweighted (``gce``,
  ``lce``); with numbers of faces in both places they are ``gce_by_face``, ``lce_by_face``;
- the cut discrepancy is one mean over the cut vertices of both segmentations, not the sum of two means.

References
----------
Chen, Golovinskiy, Funkhouser, A benchmark for 3D mesh segmentation, SIGGRAPH 2009, section 5.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from bench.princeton.surface import Segmentation, Surface

if TYPE_CHECKING:
    from segcore.arrays import FloatArray, LongArray


@dataclass(frozen=True, slots=True)
class Scores:
    """One value per metric, of one comparison or the mean of several."""

    cut_discrepancy: float  # in mean radii of the surface; nan if it is undefined
    hamming: float
    missing_rate: float
    false_alarm_rate: float
    one_minus_rand: float
    gce: float
    lce: float
    gce_by_face: float
    lce_by_face: float


METRICS = tuple(field.name for field in fields(Scores))


def evaluate(surface: Surface, candidate: Segmentation, reference: Segmentation) -> Scores:
    """Compute all metrics of a candidate segmentation against a reference of the same surface.

    Raises
    ------
    ValueError
        If the surface has fewer than three faces: the benchmark's Rand index is undefined.
    """
    faces = shared_faces(candidate, reference)
    areas = shared_areas(candidate, reference, surface.face_area)
    missing_rate, false_alarm_rate = hamming_rates(areas)
    gce, lce = consistency_errors(faces, areas)
    gce_by_face, lce_by_face = consistency_errors(faces, faces)
    return Scores(
        cut_discrepancy=cut_discrepancy(surface, candidate, reference),
        hamming=(missing_rate + false_alarm_rate) / 2,
        missing_rate=missing_rate,
        false_alarm_rate=false_alarm_rate,
        one_minus_rand=one_minus_rand(faces),
        gce=gce,
        lce=lce,
        gce_by_face=gce_by_face,
        lce_by_face=lce_by_face,
    )


def mean_scores(scores: Sequence[Scores]) -> Scores:
    """Return the mean of every metric over the comparisons in which it is defined; nan if there is none."""
    return Scores(**{metric: _mean_of_defined([getattr(score, metric) for score in scores]) for metric in METRICS})


def shared_faces(candidate: Segmentation, reference: Segmentation) -> LongArray:
    """(K_candidate, K_reference) number of faces in both C_i and R_j."""
    cell = candidate.label * reference.segments + reference.label
    count = np.bincount(cell, minlength=candidate.segments * reference.segments)
    return count.reshape(candidate.segments, reference.segments)


def shared_areas(candidate: Segmentation, reference: Segmentation, face_area: FloatArray) -> FloatArray:
    """(K_candidate, K_reference) area in both C_i and R_j."""
    cell = candidate.label * reference.segments + reference.label
    area = np.bincount(cell, weights=face_area, minlength=candidate.segments * reference.segments)
    return area.astype(np.float64).reshape(candidate.segments, reference.segments)


def one_minus_rand(faces: LongArray) -> float:
    """One minus the Rand index: the share of pairs of faces that one segmentation joins and the other separates.

    Ordered pairs over F (F - 2), thus (F - 1) / (F - 2) times the share: above 1 if nearly all pairs of a tiny mesh
    disagree.

    Parameters
    ----------
    faces : (K_candidate, K_reference) from ``shared_faces``.

    Raises
    ------
    ValueError
        If F < 3.
    """
    total = int(faces.sum())
    if total < 3:
        raise ValueError(f"The Rand index of the benchmark needs at least 3 faces, not {total}.")
    disagreeing = _sum_of_squares(faces.sum(axis=1)) + _sum_of_squares(faces.sum(axis=0)) - 2 * _sum_of_squares(faces)
    return disagreeing / (total * (total - 2))


def hamming_rates(areas: FloatArray) -> tuple[float, float]:
    """Return the missing rate and the false alarm rate; their mean is the Hamming distance.

    missing = sum over j of |R_j outside the C_i that shares the most area with it|; false alarm is the same with C and
    R exchanged.

    Parameters
    ----------
    areas : (K_candidate, K_reference) from ``shared_areas``.
    """
    total = areas.sum()
    return float(1 - areas.max(axis=0).sum() / total), float(1 - areas.max(axis=1).sum() / total)


def consistency_errors(faces: LongArray, measure: FloatArray | LongArray) -> tuple[float, float]:
    """Return the global and the local consistency error, both 0 if one segmentation refines the other.

    The local refinement error of a face in C_i and R_j is E = m(C_i outside R_j) / m(C_i) one way and
    E' = m(R_j outside C_i) / m(R_j) the other. GCE = min(sum of E, sum of E') / F, LCE = sum of min(E, E') / F, over
    the faces.

    Parameters
    ----------
    faces : (K_candidate, K_reference) from ``shared_faces``.
    measure : (K_candidate, K_reference) the measure m, from ``shared_areas`` or ``shared_faces``. A segment with
        measure 0 has no error.

    Returns
    -------
    GCE and LCE.
    """
    error = faces * _refinement_error(measure)
    opposite = faces * _refinement_error(measure.T).T
    total = faces.sum()
    return float(min(error.sum(), opposite.sum()) / total), float(np.minimum(error, opposite).sum() / total)


def cut_discrepancy(surface: Surface, candidate: Segmentation, reference: Segmentation) -> float:
    """The mean distance from the cuts of each segmentation to the cuts of the other, over the mean radius.

    The mean is over the cut vertices of both segmentations. Distances are shortest paths along the edges of the mesh.
    The mean radius is the area-weighted mean distance of the face centres to their centroid.

    Returns
    -------
    Dimensionless; nan if it is undefined: one of the two has no cut, or a cut is on a component of the mesh on which
    the other has none.
    """
    if len(candidate.cut_vertices) == 0 or len(reference.cut_vertices) == 0:
        return math.nan
    distance = np.concatenate(
        [reference.distance_to_cut[candidate.cut_vertices], candidate.distance_to_cut[reference.cut_vertices]]
    )
    return float(distance.mean() / surface.mean_radius) if np.isfinite(distance).all() else math.nan


def _sum_of_squares(counts: LongArray) -> int:
    return int((counts * counts).sum())


def _refinement_error(measure: FloatArray | LongArray) -> FloatArray:
    """(K, L) share of the measure of row i that is outside column j; 0 in rows with measure 0."""
    whole = np.broadcast_to(measure.sum(axis=1, keepdims=True), measure.shape)
    error: FloatArray = np.divide(whole - measure, whole, out=np.zeros(measure.shape), where=whole > 0)
    return error


def _mean_of_defined(values: list[float]) -> float:
    defined = [value for value in values if not math.isnan(value)]
    return sum(defined) / len(defined) if defined else math.nan
