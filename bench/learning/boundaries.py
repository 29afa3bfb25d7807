"""Where people cut: for every mesh edge of a model the share of people whose cut runs along it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from bench.learning.rows import Rows
from segcore.affinity.boundary_features import edge_features, patch_fields
from segcore.affinity.measurements import measure
from segcore.clean.surface import build_surface

if TYPE_CHECKING:
    from bench.princeton.dataset import Model
    from segcore.arrays import FloatArray, IntArray, LongArray
    from segcore.clean.surface import Surface

ROWS = 1500  # edges of a model that are learned from
_TOLERANCE = 0.012  # how far a person's cut may be from an edge, in sqrt(total area)
_SPACING = 0.004  # of the points that stand for a person's cut


def boundary_rows(model: Model, seed: int = 0) -> Rows:
    """A sample of the edges of a model, weighted so that edges count by length; cut ones are drawn more often.

    Raises
    ------
    BenchmarkError
        Where a file of the model cannot be used.
    """
    mesh = model.read_mesh()
    surface = build_surface(mesh)
    measured = measure(surface, seed)
    people = [_on_surface(surface, labels) for labels in model.read_people(len(mesh.faces))]
    share = cut_share(surface, people)
    length = measured.edges.length
    chosen, weight = _sample(length, share, np.random.default_rng(model.number))
    features = edge_features(surface, measured, patch_fields(surface, measured), chosen)
    return Rows(features.astype(np.float32), share[chosen], weight)


def cut_share(surface: Surface, people: list[LongArray]) -> FloatArray:
    """(E,): over the people, the mean of cos^2 of the angle between an edge and a cut near it, 0 where none is near."""
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
            near = np.asarray(KDTree(points).query(middle, k=8, distance_upper_bound=_TOLERANCE * size)[1])
            found = near < len(points)
            along = direction[cut[owner[np.where(found, near, 0)]]]
            cosine = np.einsum("nkj,nj->nk", along, direction)
            share += np.max(np.where(found, cosine**2, 0.0), axis=1)
    return share / max(len(people), 1)


def _on_surface(surface: Surface, labels: LongArray) -> LongArray:
    on_surface = np.zeros(len(surface.faces), dtype=np.int64)
    on_surface[surface.face_of_input] = labels
    return on_surface


def _points_along(ends: FloatArray, spacing: float) -> tuple[FloatArray, IntArray]:
    """Points at most ``spacing`` apart along edges (N, 2, 3), and the edge of each."""
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    count = np.maximum(1, np.ceil(length / spacing)).astype(int)
    owner = np.repeat(np.arange(len(ends), dtype=np.int32), count)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    place = ((number + 0.5) / count[owner])[:, None]
    return ends[owner, 0] * (1 - place) + ends[owner, 1] * place, owner


def _sample(length: FloatArray, share: FloatArray, rng: np.random.Generator) -> tuple[LongArray, FloatArray]:
    """Half of the rows by length alone, half by length times the share of people; with weights that undo the choice."""
    plain = length / length.sum()
    busy = length * share
    chance = plain if busy.sum() == 0 else 0.5 * plain + 0.5 * busy / busy.sum()
    chosen = rng.choice(len(length), size=ROWS, p=chance)
    weight = plain[chosen] / chance[chosen]
    return chosen.astype(np.int64), weight / weight.sum()
