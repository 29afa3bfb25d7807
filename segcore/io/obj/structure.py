"""The groups, objects and materials of the faces of an OBJ file."""

from typing import NamedTuple

import numpy as np

from segcore.arrays import BoolArray, LongArray
from segcore.io.text.words import Words
from segcore.structure import FileStructure, file_structure, numbered_runs

_NO_LINE = -1


class _Runs(NamedTuple):
    """Consecutive faces after the same mark."""

    mark: list[int]  # the line, -1 if there is none
    faces: list[int]  # their number


def obj_structure(words: Words, is_face: BoolArray, sizes: LongArray) -> FileStructure | None:
    """The structure of the faces that polygons with ``sizes`` (P,) corners are triangulated into, or None.

    A group is an object and the last group in it. Groups of one name in one object are one, as are materials of one
    name.
    """
    is_object = words.lines_with(b"o")
    triangles = np.maximum(sizes - 2, 0)
    groups = _runs(is_object | words.lines_with(b"g"), is_face, triangles)
    materials = _runs(words.lines_with(b"usemtl"), is_face, triangles)
    names = [None if line == _NO_LINE else words.rest_of_line(line) for line in materials.mark]
    return file_structure(
        numbered_runs(_groups(words, groups.mark, np.flatnonzero(is_object)), groups.faces),
        numbered_runs(names, materials.faces),
    )


def _runs(is_mark: BoolArray, is_face: BoolArray, triangles: LongArray) -> _Runs:
    """The runs of faces between marks; ``triangles`` (P,) is the number of faces of every polygon."""
    marks, polygons = np.flatnonzero(is_mark), np.flatnonzero(is_face)
    before, first = np.unique(np.searchsorted(marks, polygons), return_index=True)
    mark = np.append(marks, _NO_LINE)[before - 1]
    return _Runs(mark.tolist(), np.add.reduceat(triangles, first).tolist() if len(first) else [])


def _groups(words: Words, marks: list[int], objects: LongArray) -> list[tuple[str, str] | None]:
    """The names of the object and of the group that begin at every mark; None if there is no mark."""
    of_mark = np.append(objects, _NO_LINE)[np.searchsorted(objects, marks, side="right") - 1].tolist()
    return [
        None if mark == _NO_LINE else (_name(words, own), "" if mark == own else _name(words, mark))
        for mark, own in zip(marks, of_mark, strict=True)
    ]


def _name(words: Words, line: int) -> str:
    return "" if line == _NO_LINE else words.rest_of_line(line)
