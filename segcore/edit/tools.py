"""What operations on parts use besides the parts themselves, and the checks that they share."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from segcore.arrays import BoolArray, IntArray
from segcore.errors import InvalidParameters, PartLocked
from segcore.levels import Level
from segcore.partition import Partition


class PartFinder(Protocol):
    """The methods of :class:`segcore.Guide` that operations call; sets of faces are in the order of the marks."""

    def part(self, inside: IntArray, outside: IntArray) -> BoolArray:
        """(F,) the connected part that a person means who marked these faces."""

    def border(self, labels: IntArray, a: int, b: int, stroke: IntArray) -> IntArray:
        """(F,) labels with the border between two parts redrawn along a stroke, or as the least cut near it."""

    def smooth(self, labels: IntArray, parts: Sequence[int] | None) -> IntArray:
        """(F,) labels with short borders in place of jagged ones, of some parts or of all."""

    def cut(self, labels: IntArray, part: int, stroke: IntArray) -> IntArray:
        """(F,) labels with a part divided along a stroke; the new part has the next label."""


@dataclass(frozen=True, slots=True)
class Tools:
    """How operations get what only some of them need."""

    guide: Callable[[], PartFinder]
    earlier: Callable[[int, Level], Partition]  # the parts of an earlier revision, or of a level of revision 0


def checked_part(before: Partition, part: int) -> int:
    """Return the number of a part.

    Raises
    ------
    InvalidParameters
        If there is no such part.
    """
    if not 0 <= part < len(before):
        raise InvalidParameters(f"The parts are 0 to {len(before) - 1}: there is no part {part}.")
    return part


def unlocked_part(before: Partition, part: int) -> int:
    """Return the number of a part whose faces may be changed.

    Raises
    ------
    InvalidParameters
        If there is no such part.
    PartLocked
        If it is locked.
    """
    if before.parts[checked_part(before, part)].locked:
        raise PartLocked(f"Part {part} is locked: unlock it first.")
    return part


def checked_faces(before: Partition, faces: IntArray) -> IntArray:
    """Return some faces without repetitions, in the order in which they are given.

    Raises
    ------
    InvalidParameters
        If there is no such face.
    """
    count = len(before.labels)
    wrong = faces[(faces < 0) | (faces >= count)]
    if len(wrong):
        raise InvalidParameters(f"The faces are 0 to {count - 1}: there is no face {int(wrong[0])}.")
    _, first = np.unique(faces, return_index=True)
    return faces[np.sort(first)].astype(np.int32)


def is_locked_face(before: Partition) -> BoolArray:
    """(F,) True for the faces of locked parts."""
    locked: BoolArray = np.array([part.locked for part in before.parts], dtype=bool)[before.labels]
    return locked


def with_locked_faces_kept(before: Partition, labels: IntArray) -> IntArray:
    """(F,) new labels, but with the old ones of faces that are in a locked part or would move into one."""
    locked = np.array([part.locked for part in before.parts], dtype=bool)
    if not locked.any():
        return labels
    into = np.concatenate([locked, np.zeros(max(0, int(labels.max()) + 1 - len(locked)), dtype=bool)])[labels]
    return np.where(locked[before.labels] | into, before.labels, labels)
