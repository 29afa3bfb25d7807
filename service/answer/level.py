"""Which cut through the tree a result is asked for: a number of segments, a granularity, or splits chosen by hand."""

from dataclasses import dataclass, replace
from typing import Annotated

from fastapi import Depends, Query

from segcore.errors import InvalidParameters
from segcore.io.result import Segmentation
from segcore.levels import Fineness, keep_splits

_MOST_SPLITS = 10_000  # of any hierarchy


@dataclass(frozen=True, slots=True)
class ChosenCut:
    """A result at one cut."""

    result: Segmentation
    segments: int
    name: str  # the same for the same cut of the same job, as a part of an address


@dataclass(frozen=True, slots=True)
class Level:
    """What a request says."""

    fineness: Fineness
    splits: str | None  # in place of the fineness

    def of(self, result: Segmentation) -> ChosenCut:
        """The cut that is meant.

        Raises
        ------
        InvalidParameters
            Where the hierarchy has no such cut.
        """
        if self.splits is None:
            count = self.fineness.segments_of(result.hierarchy)
            return ChosenCut(result, count, f"segments={count}")
        if not self.fineness.is_automatic:
            raise InvalidParameters("Give one of segments, granularity and splits, not several.")
        chosen = sorted({int(split) for split in self.splits.split(",") if split})
        hierarchy = keep_splits(result.hierarchy, chosen)
        name = ",".join(map(str, chosen))
        return ChosenCut(replace(result, hierarchy=hierarchy), len(chosen) + 1, f"splits={name}")


Segments = Annotated[
    int | None, Query(ge=1, description="The number of segments, 1 to max_segments; by default automatic_segments.")
]
Granularity = Annotated[
    float | None,
    Query(
        ge=0,
        le=1,
        description="In place of segments: 0 is one segment, 0.5 automatic_segments, 1 max_segments; between them the "
        "number grows by equal factors for equal steps.",
        examples=[0.7],
    ),
]


async def _level(
    segments: Segments = None,
    granularity: Granularity = None,
    splits: Annotated[
        str | None,
        Query(
            pattern=r"^([0-9]{1,5}(,[0-9]{1,5})*)?$",
            max_length=6 * _MOST_SPLITS,
            description="In place of segments: the splits that are made, with commas between them. Split s makes the "
            "nodes 2 s + 1 and 2 s + 2 of the hierarchy.",
            examples=["0,1,4"],
        ),
    ] = None,
) -> Level:
    return Level(Fineness(segments, granularity), splits)


LevelOf = Annotated[Level, Depends(_level)]
