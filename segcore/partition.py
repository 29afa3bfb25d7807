"""The faces of a mesh divided into parts by any labels, with what a person has said about each part."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from segcore.arrays import IntArray, group_sums
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh, face_normals_and_areas

MOST_PARTS = 10_000  # a file of labels with more has something else than parts in it; set by hand
_LARGEST_LABEL = 999_999  # ids of datasets are smaller; set by hand


@dataclass(frozen=True, slots=True)
class Part:
    """What a person has said about a part; by default nothing."""

    name: str = ""  # empty for none
    color: str | None = None  # #rrggbb; None for the colour of its number
    class_name: str = ""  # what it is an example of; empty for none
    locked: bool = False  # whether edits leave its faces alone


@dataclass(frozen=True, slots=True, eq=False)
class Partition:
    """Labels of faces, which need not be connected, and the parts that they number.

    Raises
    ------
    InvalidParameters
        If there is a part without faces or a label without a part.
    """

    labels: IntArray  # (F,) all of 0..K - 1 occur
    parts: tuple[Part, ...] = field(default=())  # K; if none are given, nothing is said about any

    def __post_init__(self) -> None:
        """Check that the labels are the numbers of the parts."""
        labels = np.ascontiguousarray(self.labels, dtype=np.int32)
        object.__setattr__(self, "labels", labels)
        if not self.parts:
            object.__setattr__(self, "parts", (Part(),) * (int(labels.max(initial=-1)) + 1))
        low, high = int(labels.min(initial=0)), int(labels.max(initial=-1))
        if low < 0 or high != len(self.parts) - 1 or not self.face_counts.all():
            raise InvalidParameters(f"The labels must be the numbers 0 to {len(self.parts) - 1} of the parts.")

    def __len__(self) -> int:
        return len(self.parts)

    @property
    def face_counts(self) -> IntArray:
        """(K,) the number of faces of every part."""
        counts: IntArray = np.bincount(self.labels, minlength=len(self.parts)).astype(np.int32)
        return counts

    @property
    def names(self) -> dict[int, str]:
        """The names of the parts that have one, by label."""
        return {label: part.name for label, part in enumerate(self.parts) if part.name}

    @property
    def colors(self) -> dict[int, str]:
        """The colours of the parts that have their own, by label."""
        return {label: part.color for label, part in enumerate(self.parts) if part.color}

    @property
    def class_names(self) -> list[str]:
        """The classes of the parts, in the order of the alphabet."""
        return sorted({part.class_name for part in self.parts if part.class_name})

    def class_labels(self, class_names: list[str]) -> IntArray:
        """(F,) for every face 1 + the place of its part's class in a list, 0 if the part has no class.

        Raises
        ------
        InvalidParameters
            If a part has a class that is not in the list.
        """
        number = {name: place for place, name in enumerate(class_names, start=1)} | {"": 0}
        missing = [name for name in self.class_names if name not in number]
        if missing:
            raise InvalidParameters(f"Parts have the class {missing[0]!r}, which is not in the list: add it.")
        of_part = np.array([number[part.class_name] for part in self.parts], dtype=np.int32)
        classes: IntArray = of_part[self.labels]
        return classes

    def hierarchy(self, mesh: Mesh) -> Hierarchy:
        """The parts as a hierarchy of one step below the root, whose automatic level has these labels.

        Split s cuts part s + 1 off the rest, node max(2 s - 1, 0). The rest is the first child, so the label of the
        rest stays 0 and part s + 1 has the label s + 1; unlike in a hierarchy that was computed, the first child may be
        the smaller one. The values of the cuts are not known: they are infinite.
        """
        splits = np.arange(len(self.parts) - 1, dtype=np.int32)
        leaf_of = np.concatenate([[max(2 * len(splits) - 1, 0)], 2 * splits + 2]).astype(np.int32)
        split_node = np.maximum(2 * splits - 1, 0).astype(np.int32)
        face_leaf = leaf_of[self.labels]
        area = group_sums(face_leaf, face_normals_and_areas(mesh.corners)[1], 2 * len(splits) + 1)
        count = np.bincount(face_leaf, minlength=2 * len(splits) + 1)
        for values in (area, count):
            cut_off = values[leaf_of[1:]]
            values[split_node] = values.sum() - (np.cumsum(cut_off) - cut_off)
        return Hierarchy(
            split_node=split_node,
            cut_value=np.full(len(splits), np.inf),
            area=area,
            face_count=count.astype(np.int32),
            face_leaf=face_leaf,
            automatic_segments=len(self.parts),
            step=np.zeros(len(splits), dtype=np.int32),
        )


def partition_of(labels: ArrayLike, face_count: int) -> tuple[Partition, list[int]]:
    """The parts of labels that were made elsewhere, and the label that each of them had.

    The parts are numbered in the order of their labels, so labels that are 0..K - 1 already stay as they are.

    Parameters
    ----------
    labels : (F,) integers from 0; some numbers may be missing.
    face_count : F, the number of faces of the mesh.

    Raises
    ------
    InvalidParameters
        If there is not one label for each face, or a label is not a number from 0 to 999,999, or they are too many.
    """
    given = np.asarray(labels)
    if given.shape != (face_count,):
        shape = f"{len(given)}" if given.ndim == 1 else f"an array of shape {given.shape}"
        raise InvalidParameters(f"There must be a label for each of the {face_count} faces of the file, not {shape}.")
    if given.dtype.kind not in "iu":
        raise InvalidParameters(f"Labels are integers, not {given.dtype}.")
    outside = np.flatnonzero((given < 0) | (given > _LARGEST_LABEL))
    if len(outside):
        face = int(outside[0])
        raise InvalidParameters(f"Labels are numbers from 0 to {_LARGEST_LABEL}: face {face} has {int(given[face])}.")
    known, which = np.unique(given, return_inverse=True)
    if len(known) > MOST_PARTS:
        raise InvalidParameters(
            f"There are {len(known)} different labels, and at most {MOST_PARTS} parts are possible."
        )
    return Partition(which.astype(np.int32)), known.tolist()
