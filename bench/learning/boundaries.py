"""Rows for the boundary model: for the mesh edges of a model, the share of people whose cut runs along it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from bench.assets.dataset import NO_PART
from bench.datasets import on_surface
from bench.learning.rows import Rows
from segcore.affinity.boundary_features import edge_features
from segcore.affinity.measurements import measure
from segcore.affinity.patch_fields import patch_fields
from segcore.clean.refinement import refine
from segcore.clean.surface import build_surface

if TYPE_CHECKING:
    from bench.learning.examples import Example
    from segcore.arrays import FloatArray, IntArray, LongArray
    from segcore.clean.surface import Surface

# Set by hand; docs/explanation/learned-models.md describes the rows and how well the model does.
ROWS = 1500  # sampled edges of a model
_TOLERANCE = 0.012  # greatest distance between an edge and a cut that runs along it, in sqrt(total area)
_SPACING = 0.004  # of the points by which a cut is represented, in sqrt(total area): a third of the tolerance
_NEAREST = 8  # points of a cut that an edge is compared with; about six of a straight cut are within the tolerance


def boundary_rows(example: Example, seed: int = 0) -> Rows:
    """Sample the edges of a mesh, cut ones more often, with weights such that edges count by length.

    Edges of faces that belong to no part are not sampled.

    Raises
    ------
    BenchmarkError
        If a file of the mesh cannot be used.
    """
    mesh = example.read_mesh()
    whole = build_surface(mesh)
    refinement = refine(whole)
    surface = refinement.surface
    measured = measure(surface, seed)
    people = [on_surface(whole, labels)[refinement.parent] for labels in example.read_people(len(mesh.faces))]
    share = cut_share(surface, people)
    known = np.all([(labels[surface.edge_faces] != NO_PART).all(axis=1) for labels in people], axis=0)
    length = np.where(known, measured.edges.length, 0.0)
    chosen, weight = _sample(length, share, np.random.default_rng(example.seed))
    features = edge_features(surface, measured, patch_fields(surface, measured), chosen)
    return Rows(features.astype(np.float32), share[chosen], weight)


def cut_share(surface: Surface, people: list[LongArray]) -> FloatArray:
    """(E,) mean over the people of cos^2 of the angle between an edge and a cut near it, 0 if there is none.

    Parameters
    ----------
    people : (F,) each, the labels of the faces of the surface.
    """
    size = float(np.sqrt(surface.areas.sum()))
    ends = surface.vertices[surface.edge_vertices]
    middle = ends.mean(axis=1)
    direction = ends[:, 1] - ends[:, 0]
    direction /= np.maximum(np.linalg.norm(direction, axis=1, keepdims=True), np.finfo(float).tiny)
    share = np.zeros(len(ends))
    for labels in people:
        cut = np.flatnonzero(labels[surface.edge_faces[:, 0]] != labels[surface.edge_faces[:, 1]])
        if len(cut):
            points, owner = _points_along(ends[cut], _SPACING * size)
            near = np.asarray(KDTree(points).query(middle, k=_NEAREST, distance_upper_bound=_TOLERANCE * size)[1])
            found = near < len(points)
            along = direction[cut[owner[np.where(found, near, 0)]]]
            cosine = np.einsum("nkj,nj->nk", along, direction)
            share += np.max(np.where(found, cosine**2, 0.0), axis=1)
    return share / max(len(people), 1)


def _points_along(ends: FloatArray, spacing: float) -> tuple[FloatArray, IntArray]:
    """Return points at most ``spacing`` apart along edges (N, 2, 3), and the edge of each."""
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    count = np.maximum(1, np.ceil(length / spacing)).astype(int)
    owner = np.repeat(np.arange(len(ends), dtype=np.int32), count)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    place = ((number + 0.5) / count[owner])[:, None]
    return ends[owner, 0] * (1 - place) + ends[owner, 1] * place, owner


def _sample(length: FloatArray, share: FloatArray, rng: np.random.Generator) -> tuple[LongArray, FloatArray]:
    """Draw half of the rows by length, half by length times share of people; the weights correct for the choice."""
    plain = length / length.sum()
    busy = length * share
    chance = plain if busy.sum() == 0 else 0.5 * plain + 0.5 * busy / busy.sum()
    chosen = rng.choice(len(length), size=ROWS, p=chance)
    weight = plain[chosen] / chance[chosen]
    return chosen.astype(np.int64), weight / weight.sum()
