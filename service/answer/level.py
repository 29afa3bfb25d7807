"""The level of a result that a request selects: a number of segments, a granularity, or a set of splits."""

from dataclasses import dataclass, replace
from typing import Annotated

from fastapi import Depends, Query

from segcore.errors import InvalidParameters
from segcore.io import Segmentation
from segcore.levels import Fineness, keep_splits

_MAX_SPLITS = 10_000  # more than any hierarchy has


@dataclass(frozen=True, slots=True)
class ChosenCut:
    """The result of a job at one level."""

    job_id: str
    result: Segmentation
    segments: int
    name: str  # identifies the level among those of the job; a part of a URL


@dataclass(frozen=True, slots=True)
class Level:
    """The query parameters that select a level."""

    fineness: Fineness
    splits: str | None  # instead of the fineness

    def of(self, job_id: str, result: Segmentation) -> ChosenCut:
        """Return the result of a job at this level.

        Raises
        ------
        InvalidParameters
            If the hierarchy has no such level.
        """
        if self.splits is None:
            count = self.fineness.segments_of(result.hierarchy)
            return ChosenCut(job_id, result, count, f"segments={count}")
        if not self.fineness.is_automatic:
            raise InvalidParameters("Give one of segments, granularity and splits, not several.")
        chosen = sorted({int(split) for split in self.splits.split(",") if split})
        kept = replace(result, hierarchy=keep_splits(result.hierarchy, chosen))
        return ChosenCut(job_id, kept, len(chosen) + 1, f"splits={','.join(map(str, chosen))}")


Segments = Annotated[
    int | None, Query(ge=1, description="The number of segments, 1 to max_segments; by default automatic_segments.")
]
Granularity = Annotated[
    float | None,
    Query(
        ge=0,
        le=1,
        description="Instead of segments: 0 is one segment, 0.5 automatic_segments, 1 max_segments; between them the "
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
            max_length=6 * _MAX_SPLITS,
            description="Instead of segments: the splits to be made, separated by commas. Split s creates the nodes "
            "2 s + 1 and 2 s + 2 of the hierarchy.",
            examples=["0,1,4"],
        ),
    ] = None,
) -> Level:
    return Level(Fineness(segments, granularity), splits)


LevelOf = Annotated[Level, Depends(_level)]
