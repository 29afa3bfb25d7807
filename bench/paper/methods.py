"""The variants of the paper's method, and Cleave with its defaults, as methods of the comparison."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError
from bench.peers.method import MethodFailed, Outcome, source_digest
from bench.segmenter import CleaveSegmenter

if TYPE_CHECKING:
    from segcore.hierarchy import Hierarchy
    from segcore.mesh import Mesh

PRESET = "chahhou2014"


@dataclass(frozen=True, slots=True)
class CleaveMethod:
    """``segcore.segment`` with given parameters."""

    key: str
    title: str
    parameters: dict[str, object]
    only_given: bool = True  # stop at the given number of segments, like the paper, or compute the whole hierarchy

    @property
    def settings(self) -> str:
        return f"{sorted(self.parameters.items())} {self.only_given} {_digest()}"

    def prepare(self) -> None:
        """Raise BenchmarkError if the parameters are invalid."""
        CleaveSegmenter(self.parameters)

    def warm_up(self) -> None:
        """Compile the kernels of these parameters by cutting a small shape."""
        from segcore.shapes import burr

        self(burr(subdivisions=4).mesh, 4)

    def __call__(self, mesh: Mesh, segments: int) -> Outcome:
        start = time.process_time()
        try:
            hierarchy = self.hierarchy(mesh, segments)
        except BenchmarkError as error:
            raise MethodFailed(str(error)) from error
        cpu_s = time.process_time() - start
        return Outcome(hierarchy.labels(min(segments, hierarchy.max_segments)), cpu_s)

    def hierarchy(self, mesh: Mesh, segments: int) -> Hierarchy:
        """Return the tree of cuts down to at least a number of segments; raises BenchmarkError if there is none."""
        stop: dict[str, object] = {"max_segments": segments} if self.only_given else {}
        return CleaveSegmenter({**self.parameters, **stop})(mesh, seed=0)


def inverse_power() -> CleaveMethod:
    """The paper's method."""
    return _variant("inverse_power", "minima rule, p = 1 (inverse power)", solver="inverse_power")


def inverse_power_unthinned() -> CleaveMethod:
    """The paper's method without thinning: every deep concave vertex remains."""
    title = "minima rule, p = 1 (inverse power), not thinned"
    return _variant("inverse_power_unthinned", title, solver="inverse_power", thinning="none")


def split_bregman() -> CleaveMethod:
    """The paper's method with its second solver, split Bregman."""
    return _variant("split_bregman", "minima rule, p = 1 (split Bregman)", solver="split_bregman")


def two_spectral() -> CleaveMethod:
    """The paper's matrix, cut by the second eigenvector."""
    return _variant("fiedler", "minima rule, p = 2", solver="fiedler")


def inverse_power_on_adjacency() -> CleaveMethod:
    """The standard adjacency matrix, cut with p = 1."""
    title = "adjacency, p = 1 (inverse power)"
    return _variant("inverse_power_adjacency", title, solver="inverse_power", affinity="adjacency")


def two_spectral_on_adjacency() -> CleaveMethod:
    """The standard adjacency matrix, cut by the second eigenvector."""
    return _variant("fiedler_adjacency", "adjacency, p = 2", solver="fiedler", affinity="adjacency")


def cleave() -> CleaveMethod:
    """Cleave with its default parameters."""
    return CleaveMethod("cleave", "Cleave", {}, only_given=False)


def _variant(key: str, title: str, **changes: object) -> CleaveMethod:
    return CleaveMethod(key, title, {"preset": PRESET, **changes})


@cache
def _digest() -> str:
    import segcore

    return source_digest(__file__, segcore.__path__[0])
