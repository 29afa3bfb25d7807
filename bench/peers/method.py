"""The interface of a segmentation method that is compared with others on the same models."""

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
    cpu_s: float  # CPU time of the method alone; 0 if it failed
    failure: str = ""  # the reason if the method failed; the labels are then one segment


class MethodFailed(BenchmarkError):  # noqa: N818
    """A method cannot segment a mesh; the message contains the reason."""


class Method(Protocol):
    """A method with a given number of segments. It is sent to other processes, so it must be picklable."""

    @property
    def key(self) -> str:
        """A word for file names."""

    @property
    def title(self) -> str:
        """A few words for tables and charts."""

    @property
    def settings(self) -> str:
        """Everything that the labels depend on, except the mesh and the number of segments."""

    def prepare(self) -> None:
        """Prepare what all processes share; raises BenchmarkError if something is not installed."""

    def warm_up(self) -> None:
        """Compile or load everything that the first mesh needs; called once in every process."""

    def __call__(self, mesh: Mesh, segments: int) -> Outcome:
        """Segment a mesh into this number of segments, or the nearest possible; raises MethodFailed if it cannot."""


def source_digest(*sources: Path | str) -> str:
    """Return a digest of source files; of a folder, of all Python files in it."""
    digest = hashlib.sha256()
    for path in map(Path, sources):
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            digest.update(file.name.encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()[:16]
