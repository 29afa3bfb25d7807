"""The list of parts as JSON values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from segcore.coordinates import Unit
from segcore.io.palette import related_colors, segment_color_names

if TYPE_CHECKING:  # a server that returns a document from its cache needs no kernel
    from segcore.part_list.listing import MeasuredPart, PartList
    from segcore.part_list.neighbours import Neighbour
    from segcore.part_list.repeats import Copy, Repeat


def part_list_document(
    listed: PartList, unit: Unit | None = None, colors: Mapping[int, str] | None = None
) -> dict[str, Any]:
    """Return the list of parts as JSON values.

    Parameters
    ----------
    unit : the unit of length of the mesh; None if it is not known.
    colors : colours of parts by label, such as ``partition.colors``; by default those of the numbers.
    """
    shown = dict(enumerate(segment_color_names(len(listed.parts)))) | dict(colors or {})
    group = {part: place for place, repeat in enumerate(listed.repeats.groups) for part in repeat.parts}
    return {
        "unit": unit,
        "parts": [_part(part, shown[part.number], group.get(part.number)) for part in listed.parts],
        "repeats": [_repeat(repeat, shown[repeat.parts[0]]) for repeat in listed.repeats.groups],
        "repeats_complete": listed.repeats.is_complete,
    }


def _part(part: MeasuredPart, color: str, group: int | None) -> dict[str, Any]:
    box = part.box
    return {
        "number": part.number,
        "name": part.name,
        "color": color,
        "faces": part.faces,
        "area": part.area,
        "volume": part.volume,
        "why_no_volume": part.why_no_volume,
        "centre": part.centre.tolist(),
        "box": {"centre": box.centre.tolist(), "axes": box.axes.tolist(), "extents": box.extents.tolist()},
        "neighbours": [_neighbour(neighbour) for neighbour in part.neighbours],
        "repeat": group,
    }


def _neighbour(neighbour: Neighbour) -> dict[str, Any]:
    plane = neighbour.plane
    return {
        "part": neighbour.part,
        "length": neighbour.length,
        "plane": None
        if plane is None
        else {
            "point": plane.point.tolist(),
            "normal": plane.normal.tolist(),
            "largest_deviation": plane.largest_deviation,
        },
    }


def _repeat(repeat: Repeat, color: str) -> dict[str, Any]:
    colors = related_colors(color, len(repeat.copies))
    return {"copies": [_copy(copy, color) for copy, color in zip(repeat.copies, colors, strict=True)]}


def _copy(copy: Copy, color: str) -> dict[str, Any]:
    return {
        "part": copy.part,
        "transform": copy.transform.tolist(),
        "mirrored": copy.is_mirrored,
        "residual": copy.residual,
        "mean_residual": copy.mean_residual,
        "relative_residual": copy.relative_residual,
        "related_color": color,
    }
