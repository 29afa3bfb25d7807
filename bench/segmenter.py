"""Cleave's own method, as the benchmarks call it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from segcore.hierarchy import Hierarchy
    from segcore.mesh import Mesh


@dataclass(frozen=True, slots=True)
class CleaveSegmenter:
    """``segcore.segment`` with the given parameters, by name; the seed comes with every call."""

    parameters: dict[str, object] = field(default_factory=dict)

    def warm_up(self) -> None:
        from segcore.warm_up import warm_up

        warm_up()

    def __call__(self, mesh: Mesh, seed: int) -> Hierarchy:
        """The hierarchy of a mesh.

        Raises
        ------
        BenchmarkError
            Where the parameters are refused or the mesh cannot be segmented.
        """
        from segcore.errors import CleaveError
        from segcore.parameters import SegmentationParameters
        from segcore.segment import segment

        try:
            return segment(mesh, SegmentationParameters.from_mapping({**self.parameters, "seed": seed}))
        except CleaveError as error:
            raise BenchmarkError(str(error)) from error
