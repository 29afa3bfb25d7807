"""Meshes of any size: functions without arguments, to be called in another process."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from bench.princeton.dataset import find_models
from bench.scale.hard_shapes import HARD_SHAPES

if TYPE_CHECKING:
    from segcore.mesh import Mesh

Named: TypeAlias = "tuple[str, Callable[[], Mesh]]"


def dumbbells(sizes: list[int]) -> list[Named]:
    """Return dumbbells with about these numbers of faces."""
    return [("dumbbell", partial(_dumbbell, size)) for size in sizes]


def crowds() -> list[Named]:
    """Return one body, and a thousand boxes apart and in contact, all with about 12,000 faces."""
    return [
        ("one body", partial(_dumbbell, 12_000)),
        ("1,000 boxes apart", partial(_boxes, 2.0)),
        ("1,000 boxes that touch", partial(_boxes, 1.0)),
    ]


def hard_and_smooth() -> list[tuple[Named, Named]]:
    """Return meshes that are hard for their size, each with a smooth one of the same number of faces."""
    return [
        ((name, partial(make, faces)), ("dumbbell", partial(_dumbbell, faces)))
        for name, (make, faces) in HARD_SHAPES.items()
    ]


def subdivisions(folder: Path, number_of_model: int, largest: int) -> list[Named]:
    """Return a model of the benchmark with its faces split in four repeatedly, up to 1.5 ``largest`` faces.

    Raises
    ------
    BenchmarkError
        If the folder does not contain the model.
    """
    (model,) = find_models(folder, [number_of_model])
    faces = len(model.read_mesh().faces)
    times = 0
    chosen: list[Named] = []
    while faces * 4**times <= 1.5 * largest:
        chosen.append((f"{model.category} {number_of_model}", partial(_subdivided, folder, number_of_model, times)))
        times += 1
    return chosen


def _dumbbell(faces: int) -> Mesh:
    from segcore.shapes import dumbbell

    around = max(3, round((faces / 4) ** 0.5))
    return dumbbell(rings=max(2, round(faces / (2 * around))), around=around).mesh


def _boxes(spacing: float) -> Mesh:
    from segcore.shapes import box, joined

    places = [(spacing * x, spacing * y, spacing * z) for x in range(10) for y in range(10) for z in range(10)]
    return joined(*[box(centre=place) for place in places]).mesh


def _subdivided(folder: Path, number_of_model: int, times: int) -> Mesh:
    from segcore.mesh import Mesh
    from segcore.shapes import subdivide

    (model,) = find_models(folder, [number_of_model])
    mesh = model.read_mesh()
    vertices, faces = mesh.vertices, mesh.faces
    for _ in range(times):
        vertices, faces = subdivide(vertices, faces)
    return Mesh(vertices, faces)
