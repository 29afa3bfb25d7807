"""The groups, objects and materials of the faces of an OBJ file."""

from dataclasses import replace
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


def obj_structure(words: Words, is_vertex: BoolArray, is_face: BoolArray, sizes: LongArray) -> FileStructure | None:
    """The structure of the faces that polygons with ``sizes`` (P,) corners are triangulated into, or None.

    A group is an object and the last group in it. Groups of one name in one object are one, as are materials of one
    name.
    """
    others = np.flatnonzero(~(is_vertex | is_face))
    objects, in_objects, materials = (_lines(words, others, keyword) for keyword in (b"o", b"g", b"usemtl"))
    if len(objects) + len(in_objects) + len(materials) == 0:
        return None
    polygons, triangles = np.flatnonzero(is_face), np.maximum(sizes - 2, 0)
    groups = _runs(np.union1d(objects, in_objects), polygons, triangles)
    painted = _runs(materials, polygons, triangles)
    names = [None if line == _NO_LINE else words.rest_of_line(line) for line in painted.mark]
    structure = file_structure(
        numbered_runs(_groups(words, groups.mark, objects), groups.faces), numbered_runs(names, painted.faces)
    )
    used = [name for name, faces in zip(names, painted.faces, strict=True) if name is not None and faces]
    return None if structure is None else replace(structure, material_names=tuple(dict.fromkeys(used)))


def _lines(words: Words, lines: LongArray, keyword: bytes) -> LongArray:
    """Those of some lines whose first word is ``keyword``."""
    return lines[words.equal(words.line_start[lines], keyword)]


def _runs(marks: LongArray, polygons: LongArray, triangles: LongArray) -> _Runs:
    """The runs of faces between marks.

    Parameters
    ----------
    marks, polygons : lines, ascending.
    triangles : (P,) the number of faces of every polygon.
    """
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
