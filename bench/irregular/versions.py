"""Other meshes of the shape of a model: refined, decimated, with slivers or noise.

How strong each change is was set by hand; the agreements are in the table "Irregular meshes" of bench/RESULTS.md.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray
    from segcore.mesh import Mesh

# Of the decimation, 0 to 10. With 7, the default of the package, 4 of the 190 models have another shape without 80 % of
# their faces: ends of shafts are missing, up to 0.24 of the extent. With 3 all keep their shape within 0.06.
_AGGRESSIVENESS = 3


@dataclass(frozen=True, slots=True, eq=False)
class Remeshed:
    """Another mesh of the shape of a model."""

    vertices: FloatArray  # (V, 3)
    faces: IntArray  # (F, 3)
    origin: IntArray | None = None  # (F,) the face of the original that contains a face; None if they share no faces


def refined(mesh: Mesh | Remeshed, chosen: BoolArray) -> Remeshed:
    """Split the chosen faces (F,) in four at the midpoints of their edges, and their neighbours in two or three."""
    sides = np.sort(mesh.faces[:, [[0, 1], [1, 2], [2, 0]]], axis=2).astype(np.int64)
    key = sides[..., 0] * len(mesh.vertices) + sides[..., 1]
    split = np.unique(key[chosen])
    at = np.minimum(np.searchsorted(split, key), len(split) - 1)
    middle = np.where(split[at] == key, len(mesh.vertices) + at, -1)  # (F, 3) vertices on edges 01, 12, 20; or -1
    ends = np.stack([split // len(mesh.vertices), split % len(mesh.vertices)], axis=1)
    vertices = np.concatenate([mesh.vertices, mesh.vertices[ends].mean(axis=1)])
    parts: list[IntArray] = []
    parents: list[LongArray] = []
    for pattern, triangles in _PATTERNS.items():
        matching = np.flatnonzero(((middle >= 0) == np.array(pattern)).all(axis=1))
        corners = np.concatenate([mesh.faces[matching], middle[matching]], axis=1)
        parts += [corners[:, triangle] for triangle in triangles]
        parents += [matching] * len(triangles)
    origin = np.concatenate(parents)
    known = getattr(mesh, "origin", None)
    return Remeshed(
        vertices,
        np.concatenate(parts).astype(np.int32),
        (origin if known is None else known[origin]).astype(np.int32),
    )


# The triangles of a face, by which of its edges 01, 12, 20 are split; corners 0 to 2, midpoints 3 (01), 4 (12), 5 (20).
_PATTERNS: dict[tuple[bool, bool, bool], list[list[int]]] = {
    (False, False, False): [[0, 1, 2]],
    (True, False, False): [[0, 3, 2], [3, 1, 2]],
    (False, True, False): [[1, 4, 0], [4, 2, 0]],
    (False, False, True): [[2, 5, 1], [5, 0, 1]],
    (True, True, False): [[3, 1, 4], [0, 3, 4], [0, 4, 2]],
    (False, True, True): [[4, 2, 5], [1, 4, 5], [1, 5, 0]],
    (True, False, True): [[5, 0, 3], [2, 5, 3], [2, 3, 1]],
    (True, True, True): [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
}


def half_split_twice(mesh: Mesh, _: np.random.Generator) -> Remeshed:
    """Split every face of the half with the smaller coordinate along the longest axis in four, twice."""
    axis = int(np.ptp(mesh.vertices, axis=0).argmax())
    low = mesh.corners[:, :, axis].mean(axis=1)
    chosen = low < np.median(low)
    once = refined(mesh, chosen)
    assert once.origin is not None
    return refined(once, chosen[once.origin])


def patches_refined(mesh: Mesh, rng: np.random.Generator) -> Remeshed:
    """Split every face of half of the surface, in twenty random patches, in four."""
    centres = mesh.corners.mean(axis=1)
    seeds = centres[rng.choice(len(centres), 40)]
    nearest = np.asarray(KDTree(seeds).query(centres)[1])
    return refined(mesh, nearest < 20)


def slivers(mesh: Mesh, rng: np.random.Generator) -> Remeshed:
    """Split three faces of ten in three at a point next to one of their edges."""
    chosen = np.flatnonzero(rng.random(len(mesh.faces)) < 0.3)
    others = np.setdiff1d(np.arange(len(mesh.faces)), chosen)
    faces = mesh.faces[chosen]
    point = np.einsum("k,fkx->fx", [0.495, 0.495, 0.01], mesh.corners[chosen])
    new = len(mesh.vertices) + np.arange(len(chosen))
    a, b, c = faces.T
    cut = [np.stack([a, b, new], axis=1), np.stack([b, c, new], axis=1), np.stack([c, a, new], axis=1)]
    return Remeshed(
        np.concatenate([mesh.vertices, point]),
        np.concatenate([mesh.faces[others], *cut]).astype(np.int32),
        np.concatenate([others, chosen, chosen, chosen]).astype(np.int32),
    )


def noisy(mesh: Mesh, rng: np.random.Generator, share: float) -> Remeshed:
    """Move vertices at random, with a standard deviation of a share of the mean edge length along every axis."""
    sides = mesh.corners - np.roll(mesh.corners, 1, axis=1)
    deviation = share * float(np.linalg.norm(sides, axis=2).mean())
    moved = mesh.vertices + rng.normal(scale=deviation, size=mesh.vertices.shape)
    return Remeshed(moved, mesh.faces, np.arange(len(mesh.faces), dtype=np.int32))


def decimated(mesh: Mesh | Remeshed, share: float) -> Remeshed:
    """Remove a share of the faces by quadric edge collapses, or less if the shape would change.

    Raises
    ------
    BenchmarkError
        If the package fast-simplification is not installed.
    """
    try:
        import fast_simplification
    except ImportError as error:
        raise BenchmarkError("Decimation needs the package fast-simplification: pip install '.[test]'.") from error
    # The package does not take arrays that are read-only.
    vertices, faces = fast_simplification.simplify(
        mesh.vertices.copy(), mesh.faces.copy(), target_reduction=share, agg=_AGGRESSIVENESS
    )
    return Remeshed(np.asarray(vertices, dtype=np.float64), np.asarray(faces, dtype=np.int32))


def remeshed(mesh: Mesh, _: np.random.Generator) -> Remeshed:
    """Split every face in four twice, then decimate to the original number of faces: no old edge remains."""
    everywhere = refined(mesh, np.ones(len(mesh.faces), dtype=bool))
    again = refined(everywhere, np.ones(len(everywhere.faces), dtype=bool))
    return decimated(again, 1.0 - len(mesh.faces) / len(again.faces))


VERSIONS: dict[str, Callable[[Mesh, np.random.Generator], Remeshed]] = {
    "half split twice": half_split_twice,
    "80 % decimated": lambda mesh, _: decimated(mesh, 0.8),
    "50 % decimated": lambda mesh, _: decimated(mesh, 0.5),
    "patches refined": patches_refined,
    "slivers": slivers,
    "noise, 1 % of an edge": lambda mesh, rng: noisy(mesh, rng, 0.01),
    "noise, 10 % of an edge": lambda mesh, rng: noisy(mesh, rng, 0.1),
    "remeshed": remeshed,
}
