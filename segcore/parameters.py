"""Parameters of a segmentation with their ranges, defaults and JSON Schema."""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cache
from typing import Any, Literal, TypeAlias, get_args, get_origin, get_type_hints

from segcore.errors import InvalidParameters
from segcore.parameter_words import words

Graph: TypeAlias = Literal["faces", "vertices"]
Affinity: TypeAlias = Literal["learned", "concavity", "minima_rule", "adjacency"]
Structure: TypeAlias = Literal["none", "shells", "groups", "materials"]
Thinning: TypeAlias = Literal["walk", "revisit", "none"]
Solver: TypeAlias = Literal["flow", "fiedler", "inverse_power", "split_bregman", "p_laplacian"]
Order: TypeAlias = Literal["learned", "ncut", "ncc", "volume"]


USUAL_SEGMENTS = 64  # at which the hierarchy ends; the learned models were trained on such hierarchies


def _about(description: str, *, exception: int | None = None, **limits: float) -> dict[str, Any]:
    """Metadata of a field: its description, its limits in JSON Schema's words, and a value allowed outside them."""
    return {"description": description, "exception": exception, "limits": limits}


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentationParameters:
    """Choices of the method; every value is checked when the object is made.

    The number of clusters was fitted (docs/algorithm.md, section 3), the six starts are those of the paper, and the
    learned models were trained on hierarchies of 64 segments. The exponent 1.2 was set by hand.

    Raises
    ------
    InvalidParameters
        If a value is outside its range; the message contains the range and the value.
    """

    structure: Structure = field(
        default="none",
        metadata=_about(
            "Structure of the file that the first levels of the hierarchy follow: its shells (connected components), "
            "groups (nodes, objects, groups) or materials. Parts are cut below. The automatic number is that of the "
            "parts."
        ),
    )
    graph: Graph = field(default="faces", metadata=_about("Nodes of the graph: the faces or the vertices of the mesh."))
    affinity: Affinity = field(
        default="learned",
        metadata=_about("Weights of the edges of the graph; learned and concavity need graph faces."),
    )
    thinning: Thinning = field(
        default="none", metadata=_about("Thinning of the concave regions, for affinity minima_rule.")
    )
    solver: Solver = field(default="flow", metadata=_about("Algorithm that cuts a segment in two."))
    p: float = field(
        default=1.2, metadata=_about("Exponent of solver p_laplacian.", exclusiveMinimum=1, exclusiveMaximum=2)
    )
    starts: int = field(
        default=6,
        metadata=_about(
            "Number of starts of solvers inverse_power and split_bregman: the second eigenvector and random ones.",
            minimum=1,
            maximum=1000,
        ),
    )
    iterations: int | None = field(
        default=None,
        metadata=_about(
            "Iteration limit of inner problems of solvers inverse_power and split_bregman; null is their own limit.",
            minimum=1,
            maximum=1_000_000,
        ),
    )
    order: Order = field(
        default="learned",
        metadata=_about(
            "Which segment is split next: learned is the order that people would choose (ncut if the affinity is not "
            "learned); ncut and ncc take the least value of the cut, volume takes the largest segment."
        ),
    )
    max_segments: int | None = field(
        default=None,
        metadata=_about(
            "Number of segments at which the hierarchy ends; null is 64, or the number of bodies, at most 1,024, if "
            "that is more. With null and order learned the hierarchy ends earlier if no sensible cut is left.",
            minimum=1,
            maximum=10_000,
        ),
    )
    clusters: int = field(
        default=5000,
        metadata=_about(
            "Nodes of the coarse graph that is cut in place of the mesh; 0 cuts the mesh itself.",
            exception=0,
            minimum=100,
            maximum=100_000,
        ),
    )
    seed: int = field(default=0, metadata=_about("Seed of all random numbers.", minimum=0, maximum=2**32 - 1))

    def __post_init__(self) -> None:
        for name, schema in _schemas().items():
            _check(name, getattr(self, name), schema)
        if self.graph == "vertices" and self.affinity in ("learned", "concavity"):
            raise InvalidParameters(f"affinity {self.affinity!r} needs the graph of the faces: choose graph 'faces'.")

    @property
    def segment_limit(self) -> int:
        """``max_segments``, or the usual number if it is not given."""
        return self.max_segments or USUAL_SEGMENTS

    @property
    def ends_where_sensible(self) -> bool:
        """True if the hierarchy ends where the learned order finds no sensible cut left."""
        return self.max_segments is None and self.split_order == "learned"

    @property
    def measures_shape(self) -> bool:
        """True for the affinities that bending and thickness decide, and not the paper's or none."""
        return self.graph == "faces" and self.affinity in ("learned", "concavity")

    @property
    def split_order(self) -> Order:
        """``order``, with "ncut" in place of "learned" if the affinity is not learned."""
        return "ncut" if self.order == "learned" and self.affinity != "learned" else self.order

    @property
    def is_symmetric(self) -> bool:
        """True if a cut of a symmetric surface and its mirror image are one step."""
        return self.measures_shape and self.split_order in ("learned", "ncut")

    @classmethod
    def preset(cls, name: str) -> "SegmentationParameters":
        """The parameters of a named preset.

        ``"chahhou2014"`` is the method of Chahhou et al. 2014: the vertex graph with the thinned and cleaned minima
        rule, cut by the inverse power method from six starts, the segment with the least normalized Cheeger cut first.

        Raises
        ------
        InvalidParameters
            If there is no preset of that name.
        """
        if name not in _PRESETS:
            raise InvalidParameters(f"preset must be one of {', '.join(_PRESETS)}, not {name!r}.")
        return cls(**_PRESETS[name])  # type: ignore[arg-type]

    @classmethod
    def from_mapping(cls, values: Mapping[str, object]) -> "SegmentationParameters":
        """Parameters from names and values, as read from JSON or a command line.

        The name ``"preset"`` selects a preset; the other values override those of the preset.

        Raises
        ------
        InvalidParameters
            If a name is unknown or a value is outside its range.
        """
        known = {field.name for field in fields(cls)}
        unknown = sorted(set(values) - known - {"preset"})
        if unknown:
            names = ", ".join(["preset", *sorted(known)])
            near = difflib.get_close_matches(unknown[0], sorted(known), 1)
            meant = f": the nearest one is {near[0]!r}." if near else f"; the parameters are {names}."
            raise InvalidParameters(f"There is no parameter {unknown[0][:80]!r}{meant}")
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


def parameters_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of the argument of ``from_mapping``, with ranges, defaults, descriptions and titles."""
    preset = {
        **words("preset"),
        "type": "string",
        "enum": sorted(_PRESETS),
        "description": "A named set of parameters; the others override its values.",
    }
    return {"type": "object", "properties": {"preset": preset, **_schemas()}, "additionalProperties": False}


@cache
def _schemas() -> dict[str, dict[str, Any]]:
    types = get_type_hints(SegmentationParameters)
    return {
        parameter.name: {
            **_value_schema(types[parameter.name], parameter.metadata["limits"], parameter.metadata["exception"]),
            **words(parameter.name),
            "default": parameter.default,
            "description": parameter.metadata["description"],
        }
        for parameter in fields(SegmentationParameters)
    }


def _value_schema(annotation: Any, limits: dict[str, float], exception: int | None) -> dict[str, Any]:
    if get_origin(annotation) is Literal:
        return {"type": "string", "enum": list(get_args(annotation))}
    number = {"type": "number" if annotation is float else "integer", **limits}
    if type(None) in get_args(annotation):
        return {"anyOf": [number, {"type": "null"}]}
    return number if exception is None else {"anyOf": [number, {"const": exception}]}


def _check(name: str, value: Any, schema: Mapping[str, Any]) -> None:
    if "enum" in schema:
        if value not in schema["enum"]:
            raise InvalidParameters(f"{name} must be one of {', '.join(schema['enum'])}, not {value!r}.")
        return
    number, *others = schema.get("anyOf", [schema])
    if any(
        value is None if "type" in other else _is_number(value, int) and value == other["const"] for other in others
    ):
        return
    if number["type"] == "number":
        low, high = number["exclusiveMinimum"], number["exclusiveMaximum"]
        if not _is_number(value, (int, float)) or not low < value < high:
            raise InvalidParameters(f"{name} must be a number between {low} and {high}, not {value!r}.")
        return
    least, most = number["minimum"], number["maximum"]
    if not _is_number(value, int) or not least <= value <= most:
        instead = "".join(f"{other['const']} or " for other in others if "const" in other)
        raise InvalidParameters(f"{name} must be {instead}an integer from {least} to {most}, not {value!r}.")


def _is_number(value: Any, kind: type | tuple[type, ...]) -> bool:
    return isinstance(value, kind) and not isinstance(value, bool)
