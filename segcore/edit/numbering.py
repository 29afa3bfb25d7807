"""The numbers of parts in edits: those of untouched parts stay, and so do the colours of all.

If a part vanishes, the part with the highest number takes its place, with its name, colour and class.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from segcore.arrays import BoolArray, IntArray
from segcore.errors import InvalidParameters
from segcore.io.palette import segment_color_names
from segcore.partition import MOST_PARTS, Part, Partition


def without_empty_parts(labels: IntArray, parts: Sequence[Part]) -> Partition:
    """Remove the parts that have no faces.

    Parameters
    ----------
    labels : (F,) numbers 0..K - 1, of which some may be missing.
    parts : K.
    """
    has_faces = np.bincount(labels, minlength=len(parts)) > 0
    if has_faces.all():
        return Partition(labels, tuple(parts))
    colors = segment_color_names(len(parts))
    number = np.arange(len(parts), dtype=np.int32)
    kept = list(parts)
    last = len(parts) - 1
    for label in np.flatnonzero(~has_faces).tolist():
        while last > label and not has_faces[last]:
            last -= 1
        if last <= label:
            break
        kept[label] = replace(kept[last], color=kept[last].color or colors[last])
        number[last] = label
        last -= 1
    count = int(has_faces.sum())
    return Partition(number[labels], tuple(kept[:count]))


def with_new_part(before: Partition, faces: BoolArray, part: Part | None = None) -> Partition:
    """Give some faces (F,) to a new part, which gets the next number and a colour that no other part has.

    Raises
    ------
    InvalidParameters
        If there are too many parts.
    """
    count = len(before)
    if count >= MOST_PARTS:
        raise InvalidParameters(f"At most {MOST_PARTS} parts are possible: merge some first.")
    labels = np.where(faces, np.int32(count), before.labels)
    return without_empty_parts(labels, (*before.parts, replace(part or Part(), color=_free_color(before))))


def _free_color(before: Partition) -> str | None:
    """The first colour that no part has; None if that is the one of the next number anyway."""
    count = len(before)
    colors = segment_color_names(count + 1)
    used = {part.color or colors[label] for label, part in enumerate(before.parts)}
    if colors[count] not in used:
        return None
    return next((color for color in colors if color not in used), None)
