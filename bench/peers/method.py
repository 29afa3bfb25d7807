"""What a method of segmentation is, for a comparison of several on the same models."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from segcore.arrays import IntArray
    from segcore.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """One segmentation of one mesh."""

    labels: IntArray  # (F,) of any values; only which of them are equal matters
    cpu_s: float  # CPU time of the method alone; 0 where it failed
    failure: str = ""  # why there is no segmentation but one single segment


class MethodFailed(BenchmarkError):  # noqa: N818
    """A method gives no segmentation of a mesh; the message says why."""


class Method(Protocol):
    """A method that is told how many segments to make. It is sent to other processes, so it must be picklable."""

    @property
    def key(self) -> str:
        """A word for file names."""

    @property
    def title(self) -> str:
        """A few words for tables and charts."""

    @property
    def settings(self) -> str:
        """Everything but the mesh and the number of segments that its labels depend on."""

    def prepare(self) -> None:
        """Get ready what all processes share; BenchmarkError where something is not installed."""

    def warm_up(self) -> None:
        """Compile or load what the first mesh would otherwise wait for; called once in every process."""

    def __call__(self, mesh: Mesh, segments: int) -> Outcome:
        """Segment a mesh into that many segments, or as near to it as the method can; MethodFailed where it cannot."""


def source_digest(*sources: Path | str) -> str:
    """A name for the present state of source files; of a folder, for the Python files in it and below."""
    digest = hashlib.sha256()
    for path in map(Path, sources):
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            digest.update(file.name.encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()[:16]
