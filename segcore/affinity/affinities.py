"""The affinities of two neighbouring faces or vertices: how strongly they belong together.

An affinity turns a surface into one number g in (0, 1] for every edge of a graph. On the face dual graph the weight of
an edge is its length times g and the volume of a node is the area of its face, so that cuts and volumes do not depend
on how finely the shape is meshed.
"""

from dataclasses import dataclass

import numpy as np

from segcore.affinity.boundary_features import boundary_probability
from segcore.affinity.measurements import Measurements, measure
from segcore.affinity.minima_rule import minima_rule_of_faces, minima_rule_of_vertices
from segcore.arrays import FloatArray, IntArray
from segcore.clean.surface import Surface
from segcore.graphs.mesh_graph import Opposites
from segcore.parameters import SegmentationParameters
from segcore.progress import OnPart, report_nothing

# Fitted on the benchmark; the results of their neighbours are in docs/algorithm.md, "Constants" of section 2.
_FLOOR = 0.03  # g of the strongest boundary: lower lets noise be cut out, higher lets boundaries be ignored
_BENDING_SCALE = 1.4  # of concave bending
_CHANGE_SCALE = 0.3  # of the change of thickness
_PROBABILITY_SCALE = 0.05  # of the learned probability of a cut
_LEARNED_BENDING = 0.4  # weights of the measurements beside the learned probability
_LEARNED_CHANGE = 1.5


@dataclass(frozen=True, slots=True, eq=False)
class Affinity:
    """The affinity of a surface, and the thickness if it was measured for it."""

    value: FloatArray  # (E,) g in (0, 1]
    thickness: FloatArray | None = None  # (F,) logarithm of the shape diameter over sqrt(total area), smoothed
    confidence: FloatArray | None = None  # (F,) share of the rays that met the other side from inside
    grain: IntArray | None = None  # (F,) groups of faces to begin a coarsening with, if the mesh is fine
    opposites: Opposites | None = None  # pairs of faces, if the thickness was measured


def concavity(surface: Surface, parameters: SegmentationParameters, on_part: OnPart = report_nothing) -> Affinity:
    """g = 0.03 + 0.97 exp(-x / 1.4 - x3 / 0.3), x the concave bending of an edge, x3 the change of thickness across it.

    See ``segcore.affinity.measurements.measure``.
    """
    measured = measure(surface, parameters.seed, on_part)
    return _affinity(measured, measured.bending / _BENDING_SCALE + measured.change / _CHANGE_SCALE)


def learned(surface: Surface, parameters: SegmentationParameters, on_part: OnPart = report_nothing) -> Affinity:
    """g = 0.03 + 0.97 exp(-p / 0.05 - 0.4 x - 1.5 x3), p the probability that a person cuts along the edge.

    See ``segcore.affinity.boundary_features``.
    """
    measured = measure(surface, parameters.seed, on_part)
    probability = boundary_probability(surface, measured, on_part)
    return _affinity(
        measured,
        probability / _PROBABILITY_SCALE + _LEARNED_BENDING * measured.bending + _LEARNED_CHANGE * measured.change,
    )


def adjacency_of_faces(surface: Surface, _: SegmentationParameters, _on_part: OnPart = report_nothing) -> Affinity:
    """g = 1: the standard adjacency matrix of the faces."""
    return Affinity(np.ones(len(surface.edge_faces)))


def adjacency_of_vertices(_surface: Surface, ends: IntArray, _: SegmentationParameters) -> FloatArray:
    """(E,) g = 1: the standard adjacency matrix of the vertices."""
    return np.ones(len(ends))


FACE_AFFINITIES = {
    "concavity": concavity,
    "learned": learned,
    "minima_rule": lambda surface, parameters, _on_part: Affinity(minima_rule_of_faces(surface, parameters)),
    "adjacency": adjacency_of_faces,
}
VERTEX_AFFINITIES = {"minima_rule": minima_rule_of_vertices, "adjacency": adjacency_of_vertices}


def _affinity(measured: Measurements, distance: FloatArray) -> Affinity:
    """g = 0.03 + 0.97 exp(-distance) with distances (E,), and the thickness of the patch of every face."""
    patch = measured.patches.of_face
    value = _FLOOR + (1.0 - _FLOOR) * np.exp(-distance)
    thickness = measured.thickness
    return Affinity(
        value, measured.log_thickness[patch], thickness.confidence[patch], measured.patches.grain, thickness.opposites
    )
