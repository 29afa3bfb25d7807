"""Computes digests of labels and files."""

from __future__ import annotations

import hashlib
from io import BytesIO
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from bench.datasets import read_mesh
from bench.errors import BenchmarkError
from segcore.errors import CleaveError
from segcore.io.writing import WRITERS
from segcore.method import segment
from segcore.parameters import SegmentationParameters

if TYPE_CHECKING:
    from bench.digests.selection import Subject
    from segcore.hierarchy import Hierarchy

LEVELS = (2, 5, 7, 12, 30)  # numbers of segments from coarse to fine, below the default of max_segments
FORMATS = ("glb", "cleave")
_DIGITS = 24  # of SHA-256 in hexadecimal: 96 bits

# By level or format a digest; under "segments" the automatic and the largest number of segments.
Digests: TypeAlias = dict[str, str | list[int]]


def record(subject: Subject) -> Digests:
    """Segment a mesh and return the digests of its labels and files.

    Raises
    ------
    BenchmarkError
        If the mesh cannot be read or segmented.
    """
    mesh = read_mesh(subject.path, subject.key)
    try:
        hierarchy = segment(mesh, SegmentationParameters.from_mapping(subject.parameters))
    except CleaveError as error:
        raise BenchmarkError(f"{subject.key}: {error}") from error
    digests: Digests = {str(level): _labels(hierarchy, level) for level in LEVELS}
    digests["auto"] = _labels(hierarchy, hierarchy.automatic_segments)
    digests["segments"] = [int(hierarchy.automatic_segments), int(hierarchy.max_segments)]
    for name in FORMATS:
        target = BytesIO()
        WRITERS[name].write(target, mesh, hierarchy, None)
        digests[name] = _digest(target.getvalue())
    return digests


def _labels(hierarchy: Hierarchy, level: int) -> str:
    """Return the digest of the labels at a level, or at the finest one if there are fewer segments."""
    labels = hierarchy.labels(min(level, hierarchy.max_segments))
    return _digest(np.ascontiguousarray(labels, dtype="<i4").tobytes())


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:_DIGITS]
