"""The operations of a person on parts. Each is a value whose ``applied`` returns the new parts.

Faces of locked parts stay in them: operations pass over them, and refuse to change the faces of a locked part that they
name. Every operation raises InvalidParameters if it names a part or a face that does not exist, and PartLocked if it
names a locked part; names, colours and classes of locked parts may be changed. Undo is :class:`Restore`, which also
restores the locks.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Literal, Protocol, TypeAlias

import numpy as np

from segcore.arrays import BoolArray, IntArray
from segcore.edit.numbering import with_new_part, without_empty_parts
from segcore.edit.tools import (
    Tools,
    checked_faces,
    checked_part,
    is_locked_face,
    unlocked_part,
    with_locked_faces_kept,
)
from segcore.errors import InvalidParameters, PartLocked
from segcore.levels import Level
from segcore.partition import Part, Partition

_AUTOMATIC = Level()
Target: TypeAlias = int | Literal["new"]  # an existing part, or a new one


class Operation(Protocol):
    """One change of the parts."""

    needs_guide: ClassVar[bool]

    @property
    def words(self) -> str:
        """What it does, for the list of revisions."""

    def applied(self, before: Partition, tools: Tools) -> Partition:
        """Return the parts after it."""


def apply_all(before: Partition, operations: Iterable[Operation], tools: Tools) -> Partition:
    """Return the parts after some operations, of which each refers to the parts after the one before it.

    Raises
    ------
    InvalidParameters, PartLocked
        As of the first operation that cannot be applied.
    """
    for operation in operations:
        before = operation.applied(before, tools)
    return before


def in_words(operations: Sequence[Operation]) -> str:
    """Return what some operations do, equal ones counted."""
    counted: dict[str, int] = {}
    for operation in operations:
        counted[operation.words] = counted.get(operation.words, 0) + 1
    return "; ".join(words if count == 1 else f"{words} ({count} times)" for words, count in counted.items())


@dataclass(frozen=True, slots=True)
class Merge:
    """Several parts become one, which has the number, the colour and the lock of the first.

    It has the name and the class of the first of them that has any.
    """

    parts: tuple[int, ...]
    needs_guide: ClassVar[bool] = False

    @property
    def words(self) -> str:
        return f"merge parts {', '.join(map(str, self.parts))}"

    def applied(self, before: Partition, tools: Tools) -> Partition:  # noqa: ARG002
        chosen = [unlocked_part(before, part) for part in dict.fromkeys(self.parts)]
        if len(chosen) < 2:
            raise InvalidParameters("To merge parts, name at least two of them.")
        merged = [before.parts[part] for part in chosen]
        parts = list(before.parts)
        parts[chosen[0]] = replace(
            merged[0],
            name=next((part.name for part in merged if part.name), ""),
            class_name=next((part.class_name for part in merged if part.class_name), ""),
        )
        return without_empty_parts(np.where(np.isin(before.labels, chosen), chosen[0], before.labels), parts)


@dataclass(frozen=True, slots=True, eq=False)
class Assign:
    """Faces are moved to a part."""

    faces: IntArray
    to: Target
    needs_guide: ClassVar[bool] = False

    @property
    def words(self) -> str:
        return f"move {len(self.faces)} faces to {_target_words(self.to)}"

    def applied(self, before: Partition, tools: Tools) -> Partition:  # noqa: ARG002
        return _moved(before, checked_faces(before, self.faces), self.to)


@dataclass(frozen=True, slots=True, eq=False)
class FindPart:
    """The part that a person means who marked faces inside and outside of it becomes a part."""

    inside: IntArray
    outside: IntArray
    to: Target
    needs_guide: ClassVar[bool] = True

    @property
    def words(self) -> str:
        return f"part from marks to {_target_words(self.to)}"

    def applied(self, before: Partition, tools: Tools) -> Partition:
        inside, outside = checked_faces(before, self.inside), checked_faces(before, self.outside)
        if len(inside) == 0:
            raise InvalidParameters("Mark at least one face inside the part.")
        both = np.intersect1d(inside, outside)
        if len(both):
            raise InvalidParameters(f"Face {int(both[0])} is marked as inside and as outside: remove one of the marks.")
        found = np.flatnonzero(tools.guide().part(inside, outside)).astype(np.int32)
        return _moved(before, found, self.to)


@dataclass(frozen=True, slots=True, eq=False)
class Cut:
    """A part is divided along a stroke of faces; one side becomes a new part."""

    part: int
    stroke: IntArray
    needs_guide: ClassVar[bool] = True

    @property
    def words(self) -> str:
        return f"cut part {self.part}"

    def applied(self, before: Partition, tools: Tools) -> Partition:
        part, stroke = unlocked_part(before, self.part), checked_faces(before, self.stroke)
        if len(stroke) == 0:
            raise InvalidParameters("A cut follows a stroke: give the faces below it.")
        after = tools.guide().cut(before.labels, part, stroke)
        new = (after != before.labels) & (before.labels == part)
        if not new.any() or not (before.labels[~new] == part).any():
            raise InvalidParameters(f"The stroke does not divide part {part}: draw it across the part.")
        return with_new_part(before, new)


@dataclass(frozen=True, slots=True, eq=False)
class Border:
    """The border between two parts is redrawn along a stroke of faces, or without one as the least cut near it."""

    a: int
    b: int
    stroke: IntArray
    needs_guide: ClassVar[bool] = True

    @property
    def words(self) -> str:
        return f"redraw the border of parts {self.a} and {self.b}"

    def applied(self, before: Partition, tools: Tools) -> Partition:
        a, b = unlocked_part(before, self.a), unlocked_part(before, self.b)
        if a == b:
            raise InvalidParameters("A border has two parts: name two different ones.")
        after = tools.guide().border(before.labels, a, b, checked_faces(before, self.stroke))
        both = np.isin(before.labels, (a, b))
        return without_empty_parts(np.where(both, after, before.labels), before.parts)


@dataclass(frozen=True, slots=True)
class Smooth:
    """The borders of some parts, or of all that are not locked, become short."""

    parts: tuple[int, ...] | None
    needs_guide: ClassVar[bool] = True

    @property
    def words(self) -> str:
        return "smooth the borders" + (f" of parts {', '.join(map(str, self.parts))}" if self.parts else "")

    def applied(self, before: Partition, tools: Tools) -> Partition:
        parts = None if self.parts is None else [unlocked_part(before, part) for part in self.parts]
        after = tools.guide().smooth(before.labels, parts)
        return without_empty_parts(with_locked_faces_kept(before, after), before.parts)


@dataclass(frozen=True, slots=True)
class Describe:
    """What is said about a part is changed; None leaves it, an empty text removes it."""

    part: int
    name: str | None = None
    color: str | None = None
    class_name: str | None = None
    locked: bool | None = None
    needs_guide: ClassVar[bool] = False

    @property
    def words(self) -> str:
        said = [
            None if self.name is None else f"name part {self.part} {self.name!r}",
            None if self.color is None else f"colour of part {self.part}",
            None if self.class_name is None else f"class of part {self.part} {self.class_name!r}",
            None if self.locked is None else f"{'lock' if self.locked else 'unlock'} part {self.part}",
        ]
        return ", ".join(filter(None, said))

    def applied(self, before: Partition, tools: Tools) -> Partition:  # noqa: ARG002
        part = before.parts[checked_part(before, self.part)]
        changed = Part(
            name=part.name if self.name is None else self.name,
            color=part.color if self.color is None else self.color or None,
            class_name=part.class_name if self.class_name is None else self.class_name,
            locked=part.locked if self.locked is None else self.locked,
        )
        return replace(before, parts=(*before.parts[: self.part], changed, *before.parts[self.part + 1 :]))


@dataclass(frozen=True, slots=True)
class Restore:
    """The parts become what they were in an earlier revision."""

    revision: int
    level: Level = _AUTOMATIC  # of the automatic result, if the revision is 0
    needs_guide: ClassVar[bool] = False

    @property
    def words(self) -> str:
        return f"restore revision {self.revision}"

    def applied(self, before: Partition, tools: Tools) -> Partition:  # noqa: ARG002
        return tools.earlier(self.revision, self.level)


def _target_words(to: Target) -> str:
    return "a new part" if to == "new" else f"part {to}"


def _moved(before: Partition, faces: IntArray, to: Target) -> Partition:
    """Move some faces to a part, except those of locked parts.

    Raises
    ------
    PartLocked
        If all of them are in locked parts.
    """
    if len(faces) == 0:
        raise InvalidParameters("There are no faces to be moved: give at least one.")
    target = None if to == "new" else unlocked_part(before, to)
    chosen: BoolArray = np.zeros(len(before.labels), dtype=bool)
    chosen[faces] = True
    chosen &= ~is_locked_face(before)
    if not chosen.any():
        raise PartLocked("All of these faces are in locked parts: unlock these parts first.")
    if target is None:
        return with_new_part(before, chosen)
    return without_empty_parts(np.where(chosen, np.int32(target), before.labels), before.parts)
