"""How finely a mesh is to be parted, in words of the caller: a number of segments, a granularity, or neither."""

from dataclasses import dataclass

from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy


@dataclass(frozen=True, slots=True)
class Fineness:
    """At most one of the two; with neither it is what the mesh itself suggests.

    Raises
    ------
    InvalidParameters
        Where both are given.
    """

    segments: int | None = None
    granularity: float | None = None  # 0 coarse, 0.5 automatic, 1 fine

    def __post_init__(self) -> None:
        if self.segments is not None and self.granularity is not None:
            raise InvalidParameters("Give either segments or granularity, not both.")

    @property
    def is_automatic(self) -> bool:
        return self.segments is None and self.granularity is None

    def segments_of(self, hierarchy: Hierarchy) -> int:
        """The number of segments that is meant, in this hierarchy.

        Raises
        ------
        InvalidParameters
            Where the granularity is not in 0..1, or the hierarchy has not as many segments.
        """
        if self.granularity is not None:
            return hierarchy.segments_at(self.granularity)
        return len(hierarchy.segment_nodes(self.segments))
