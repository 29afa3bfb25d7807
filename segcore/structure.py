"""The groups and materials of the faces of a mesh file."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np

from segcore.arrays import IntArray
from segcore.errors import InvalidMesh

NO_ENTRY = -1  # of a face that is in no group, or has no material


@dataclass(frozen=True, slots=True, eq=False)
class FileStructure:
    """The group and the material of every face, by number; None for what the file does not have.

    Groups are nodes of glTF, objects and groups of OBJ, placed objects of 3MF, and solids of STL. Numbers start at 0,
    in the order of the file; -1 is a face without.

    Raises
    ------
    InvalidMesh
        If a number is below -1.
    """

    group: IntArray | None = None  # (F,)
    material: IntArray | None = None  # (F,)
    material_names: tuple[str, ...] = ()  # by number, of OBJ files

    def __post_init__(self) -> None:
        for numbers in (self.group, self.material):
            if numbers is not None and (numbers.ndim != 1 or numbers.min(initial=NO_ENTRY) < NO_ENTRY):
                raise InvalidMesh("The groups and materials of faces must be lists of numbers from -1.")

    def fits(self, face_count: int) -> bool:
        """Whether the arrays match a mesh of this size."""
        return all(numbers is None or len(numbers) == face_count for numbers in (self.group, self.material))


def numbered_runs(keys: Sequence[Hashable], sizes: Sequence[int]) -> IntArray | None:
    """(F,) the numbers of consecutive faces: run i has ``sizes[i]`` faces, and equal keys have equal numbers.

    The key None is that of faces without an entry. Returns None if no face has one.
    """
    used = [None if size == 0 else key for key, size in zip(keys, sizes, strict=True)]
    number: dict[Hashable, int] = {}
    for key in used:
        if key is not None:
            number.setdefault(key, len(number))
    if not number:
        return None
    return np.repeat(np.array([number.get(key, NO_ENTRY) for key in used], dtype=np.int32), sizes)


def file_structure(group: IntArray | None, material: IntArray | None) -> FileStructure | None:
    """The structure, or None if the file has neither groups nor materials."""
    return None if group is None and material is None else FileStructure(group, material)
