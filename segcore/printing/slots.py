"""Filament slots: the parts grouped by colour."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from segcore.io.palette import SegmentColors, color_bytes, oklab


@dataclass(frozen=True, slots=True)
class Slot:
    """A filament and the parts that are printed with it."""

    number: int  # from 1
    color: str  # #rrggbb
    labels: tuple[int, ...]


def slots_of(
    labels: Sequence[int],
    volumes: Mapping[int, float],
    count: int,
    most: int | None,
    part_colors: SegmentColors | None = None,
) -> list[Slot]:
    """Group parts by colour into at most ``most`` slots, by default one per colour.

    The two groups whose colours are nearest in OKLab are joined until the number is reached. The colour of a group is
    that of its colour with the largest volume. Slots are ordered by their first part.

    Parameters
    ----------
    labels : the parts in ascending order, all below ``count``.
    volumes : of the parts that are solids.
    part_colors : colours by label, in place of the fixed ones.
    """
    colors = [f"#{bytes(color).hex()}" for color in color_bytes(count, part_colors)]
    groups: dict[str, list[int]] = {}
    for label in labels:
        groups.setdefault(colors[label], []).append(label)
    while most is not None and len(groups) > most:
        _join_nearest(groups, volumes)
    ordered = sorted(groups.items(), key=lambda group: min(group[1]))
    return [Slot(k + 1, color, tuple(sorted(own))) for k, (color, own) in enumerate(ordered)]


def _join_nearest(groups: dict[str, list[int]], volumes: Mapping[int, float]) -> None:
    names = list(groups)
    places = oklab(np.array([list(bytes.fromhex(name[1:])) for name in names]) / 255)
    gap = np.linalg.norm(places[:, None] - places, axis=2)
    np.fill_diagonal(gap, np.inf)
    pair = [names[k] for k in divmod(int(gap.argmin()), len(names))]
    weight = {name: sum(volumes.get(label, 0.0) for label in groups[name]) for name in pair}
    kept, left = sorted(pair, key=lambda name: -weight[name])
    groups[kept] += groups.pop(left)
