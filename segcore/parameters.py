"""What a caller may choose about a segmentation, and the only home of the defaults."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Literal, TypeAlias, get_args

from segcore.errors import InvalidParameters

Graph: TypeAlias = Literal["faces", "vertices"]
Affinity: TypeAlias = Literal["concavity", "minima_rule", "adjacency"]
Thinning: TypeAlias = Literal["walk", "revisit", "none"]
Solver: TypeAlias = Literal["flow", "fiedler", "inverse_power", "split_bregman", "p_laplacian"]
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
    p: float = 1.2  # between 1 and 2: of solver "p_laplacian"
    starts: int = (
        6  # 1..1000: of solvers inverse_power and split_bregman; one is the second eigenvector, the rest random
    )
    iterations: int | None = None  # 1..1000000: limit of their inner problems; None: the solver's own
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
        if isinstance(self.p, bool) or not isinstance(self.p, (int, float)) or not 1 < self.p < 2:
            raise InvalidParameters(f"p must be a number between 1 and 2, not {self.p!r}.")
        _check_integer("starts", self.starts, 1, 1000)
        if self.iterations is not None:
            _check_integer("iterations", self.iterations, 1, 1_000_000)
        _check_choice("order", self.order, get_args(Order))
        _check_integer("max_segments", self.max_segments, 1, 10_000)
        if self.clusters != 0:
            _check_integer("clusters", self.clusters, 100, 100_000, "0 or ")
        _check_integer("seed", self.seed, 0, 2**32 - 1)

    @classmethod
    def preset(cls, name: str) -> "SegmentationParameters":
        """Parameters that belong together under a name.

        ``"chahhou2014"`` is the method of Chahhou et al. 2014: the vertex graph with the thinned and cleaned minima
        rule, cut by the inverse power method from six starts, the segment with the least normalized Cheeger cut first.
        """
        if name not in _PRESETS:
            raise InvalidParameters(f"preset must be one of {', '.join(_PRESETS)}, not {name!r}.")
        return cls(**_PRESETS[name])  # type: ignore[arg-type]

    @classmethod
    def from_mapping(cls, values: Mapping[str, object]) -> "SegmentationParameters":
        """Parameters from names and values, as they come from JSON or a command line.

        Under the name ``"preset"`` they may have the name of a preset, which the others then change.
        """
        known = {field.name for field in fields(cls)}
        unknown = sorted(set(values) - known - {"preset"})
        if unknown:
            names = ", ".join(["preset", *sorted(known)])
            raise InvalidParameters(f"Unknown parameter {unknown[0]!r}; the parameters are {names}.")
        start = cls.preset(str(values["preset"])) if "preset" in values else cls()
        chosen = {name: value for name, value in values.items() if name != "preset"}
        return replace(start, **chosen)  # type: ignore[arg-type]


_PRESETS: dict[str, dict[str, object]] = {
    "chahhou2014": {
        "graph": "vertices",
        "affinity": "minima_rule",
        "thinning": "walk",
        "solver": "inverse_power",
        "starts": 6,
        "order": "ncc",
        "clusters": 0,
    }
}


def _check_integer(name: str, value: object, least: int, most: int, instead: str = "") -> None:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise InvalidParameters(f"{name} must be {instead}an integer from {least} to {most}, not {value!r}.")


def _check_choice(name: str, value: object, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise InvalidParameters(f"{name} must be one of {', '.join(choices)}, not {value!r}.")
