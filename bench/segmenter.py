"""Calls Cleave's segmentation for the benchmarks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from segcore.hierarchy import Hierarchy
    from segcore.mesh import Mesh
    from segcore.parameters import SegmentationParameters


@dataclass(frozen=True, slots=True)
class CleaveSegmenter:
    """``segcore.segment`` with parameters by name; the seed is an argument of each call.

    Raises
    ------
    BenchmarkError
        If a parameter is unknown or outside its range.
    """

    parameters: dict[str, object] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._parameters(seed=0)

    def warm_up(self) -> None:
        from segcore import warm_up

        warm_up()

    def __call__(self, mesh: Mesh, seed: int) -> Hierarchy:
        """Segment a mesh.

        Raises
        ------
        BenchmarkError
            If the seed is outside its range or the mesh cannot be segmented.
        """
        from segcore.errors import CleaveError
        from segcore.method import segment

        try:
            return segment(mesh, self._parameters(seed))
        except CleaveError as error:
            raise BenchmarkError(str(error)) from error

    def _parameters(self, seed: int) -> SegmentationParameters:
        from segcore.errors import InvalidParameters
        from segcore.parameters import SegmentationParameters

        try:
            return SegmentationParameters.from_mapping({**self.parameters, "seed": seed})
        except InvalidParameters as error:
            raise BenchmarkError(str(error)) from error
