"""Segmentations that are computed once in a process, because many tests submit the same mesh."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import pytest

import segcore
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh
from segcore.parameters import SegmentationParameters
from segcore.progress import OnProgress

_MOST_FACES = 5_000  # larger meshes are segmented each time

_compute = segcore.segment
_known: dict[object, tuple[Hierarchy, list[tuple[str, float]]]] = {}


@contextmanager
def remembered_segmentations() -> Iterator[None]:
    """Let ``segcore.segment`` give the hierarchy, and the progress, of the first time if it gets a small mesh again.

    Kernels are warmed up once, too.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(segcore, "warm_up", cache(segcore.warm_up))
        patch.setattr(segcore, "segment", _segment)
        yield


def _segment(
    mesh: Mesh,
    parameters: SegmentationParameters | None = None,
    on_progress: OnProgress = lambda *_: None,
    surface: Any = None,
) -> Hierarchy:
    chosen = parameters or SegmentationParameters()
    if chosen.structure != "none" or len(mesh.faces) > _MOST_FACES:
        return _compute(mesh, chosen, on_progress, surface)
    key = mesh.vertices.tobytes(), mesh.faces.tobytes(), chosen
    if key not in _known:
        steps: list[tuple[str, float]] = []
        _known[key] = _compute(mesh, chosen, lambda *step: steps.append(step), surface), steps
    hierarchy, steps = _known[key]
    for step in steps:
        on_progress(*step)
    return hierarchy
