"""What a caller may choose about a segmentation, and the only home of the defaults."""

from dataclasses import dataclass, fields
from typing import Literal, TypeAlias, get_args

from segcore.errors import InvalidParameters

Graph: TypeAlias = Literal["faces", "vertices"]
Affinity: TypeAlias = Literal["concavity", "minima_rule", "adjacency"]
Thinning: TypeAlias = Literal["walk", "revisit", "none"]
Solver: TypeAlias = Literal["flow", "fiedler"]
Order: TypeAlias = Literal["ncut", "ncc", "volume"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentationParameters:
    """Choices of the method; every value is checked when the object is made.

    Raises
    ------
    InvalidParameters
        Where a value is outside its range; the message has the range and the value.
    """

    graph: Graph = "faces"  # the nodes of the graph that is cut
    affinity: Affinity = "concavity"  # the weights of its edges
    thinning: Thinning = "none"  # of the concave regions of affinity "minima_rule"
    solver: Solver = "flow"  # how a segment is cut
    order: Order = "ncut"  # the segment with the least value, or the largest volume, is split next
    max_segments: int = 64  # 1..10000: where the hierarchy ends
    clusters: int = 2500  # 100..100000: nodes of the coarse graph that is cut in place of the mesh; 0: the mesh itself
    seed: int = 0  # 0..2**32 - 1: of the random order in which the coarsening visits faces

    def __post_init__(self) -> None:
        _check_choice("graph", self.graph, get_args(Graph))
        _check_choice("affinity", self.affinity, get_args(Affinity))
        if self.graph == "vertices" and self.affinity == "concavity":
            raise InvalidParameters("affinity 'concavity' needs the graph of the faces: choose graph 'faces'.")
        _check_choice("thinning", self.thinning, get_args(Thinning))
        _check_choice("solver", self.solver, get_args(Solver))
        _check_choice("order", self.order, get_args(Order))
        _check_integer("max_segments", self.max_segments, 1, 10_000)
        if self.clusters != 0:
            _check_integer("clusters", self.clusters, 100, 100_000, "0 or ")
        _check_integer("seed", self.seed, 0, 2**32 - 1)

    @classmethod
    def from_mapping(cls, values: dict[str, object]) -> "SegmentationParameters":
        """Parameters from names and values, as they come from JSON or a command line."""
        known = {field.name for field in fields(cls)}
        unknown = sorted(set(values) - known)
        if unknown:
            raise InvalidParameters(f"Unknown parameter {unknown[0]!r}; the parameters are {', '.join(sorted(known))}.")
        return cls(**values)  # type: ignore[arg-type]


def _check_integer(name: str, value: object, least: int, most: int, instead: str = "") -> None:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise InvalidParameters(f"{name} must be {instead}an integer from {least} to {most}, not {value!r}.")


def _check_choice(name: str, value: object, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise InvalidParameters(f"{name} must be one of {', '.join(choices)}, not {value!r}.")
