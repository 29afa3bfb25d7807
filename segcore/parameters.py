"""What a caller may choose about a segmentation, and the only home of the defaults."""

from dataclasses import dataclass, fields

from segcore.errors import InvalidParameters


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentationParameters:
    """Choices of the method; every value is checked when the object is made.

    Raises
    ------
    InvalidParameters
        Where a value is outside its range; the message has the range and the value.
    """

    max_segments: int = 64  # 1..10000: where the hierarchy ends
    clusters: int = 2500  # 100..100000: nodes of the coarse graph that is cut in place of the mesh
    seed: int = 0  # 0..2**32 - 1: of the random order in which the coarsening visits faces

    def __post_init__(self) -> None:
        _check_integer("max_segments", self.max_segments, 1, 10_000)
        _check_integer("clusters", self.clusters, 100, 100_000)
        _check_integer("seed", self.seed, 0, 2**32 - 1)

    @classmethod
    def from_mapping(cls, values: dict[str, object]) -> "SegmentationParameters":
        """Parameters from names and values, as they come from JSON or a command line."""
        known = {field.name for field in fields(cls)}
        unknown = sorted(set(values) - known)
        if unknown:
            raise InvalidParameters(f"Unknown parameter {unknown[0]!r}; the parameters are {', '.join(sorted(known))}.")
        return cls(**values)  # type: ignore[arg-type]


def _check_integer(name: str, value: object, least: int, most: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise InvalidParameters(f"{name} must be an integer from {least} to {most}, not {value!r}.")
