"""The level of a result that a request selects: a number of segments, a granularity, or a set of splits."""

from dataclasses import dataclass, replace
from typing import Annotated, Any

from fastapi import Depends, Query

from segcore import Partition
from segcore.arrays import IntArray
from segcore.io import Segmentation
from segcore.levels import Fineness, Level

_MAX_SPLITS = 10_000  # more than any hierarchy has


@dataclass(frozen=True, slots=True)
class ChosenCut:
    """The result of a job at one level."""

    job_id: str
    result: Segmentation
    segments: int
    name: str  # identifies the level among those of the job; a part of a URL
    is_newest: bool = False  # the newest revision was requested, so that the next response may be another one

    def of_newest(self) -> "ChosenCut":
        """Return the same, requested as the newest revision."""
        return replace(self, is_newest=True)

    @property
    def labels(self) -> IntArray:
        """(F,) the segment of every face."""
        return self.result.hierarchy.labels(self.segments)

    @property
    def partition(self) -> Partition | None:
        """The parts of a revision; None for a level of the automatic result."""
        return None if self.result.edited is None else self.result.edited.partition

    def looks(self, names: dict[int, str]) -> dict[str, Any]:
        """Return the names and colours of the parts as writers take them; given names replace those of a revision."""
        if self.partition is None:
            return {"names": names}
        return {"names": self.partition.names | names, "part_colors": self.partition.colors}


def cut_at(job_id: str, result: Segmentation, level: Level) -> ChosenCut:
    """Return the result of a job at a level.

    Raises
    ------
    InvalidParameters
        If the hierarchy has no such level.
    """
    hierarchy, count = level.of(result.hierarchy)
    name = f"segments={count}"
    if level.splits is not None:
        name = f"splits={','.join(map(str, sorted(set(level.splits))))}"
    return ChosenCut(job_id, replace(result, hierarchy=hierarchy), count, name)


def revised_cut(job_id: str, revised: Segmentation, number: int, *, is_newest: bool = False) -> ChosenCut:
    """Return the parts of a revision of a job.

    Parameters
    ----------
    revised : the mesh, and the parts as its hierarchy.
    is_newest : the newest revision was requested, whatever its number.
    """
    return ChosenCut(job_id, revised, revised.hierarchy.automatic_segments, f"revision={number}", is_newest=is_newest)


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
    chosen = None if splits is None else tuple(sorted({int(split) for split in splits.split(",") if split}))
    return Level(Fineness(segments, granularity), chosen)


LevelOf = Annotated[Level, Depends(_level)]
