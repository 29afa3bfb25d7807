"""The list of parts."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from segcore.arrays import FloatArray, IntArray, group_sums
from segcore.clean.surface import build_surface
from segcore.errors import InvalidParameters
from segcore.io.parts.pieces import Part, closed_groups, labels_on, open_groups, positions
from segcore.io.slices import group
from segcore.mesh import Mesh, face_normals_and_areas
from segcore.part_list.boxes import OrientedBox, oriented_box
from segcore.part_list.neighbours import Neighbour, neighbours_of_parts
from segcore.part_list.part_shape import PartShape
from segcore.part_list.repeats import Repeats, find_repeats
from segcore.part_list.tolerance import TOLERANCE
from segcore.partition import partition_of

# Normals of the hull that are tried for a box: fewer if there are many parts. Set by hand; see bench/RESULTS.md.
_MOST_NORMALS, _LEAST_NORMALS, _NORMALS_OF_ALL = 24, 4, 4096

_LARGEST = 1e70  # coordinate; squares of areas of larger meshes, and of those smaller than 1 / this, are not in float64
_NO_AREA = 1e-12  # of the square of the size: rounding error
_NOTHING_LEFT = "All of its faces are degenerate or repeat faces of other parts."
_NOT_MANIFOLD = "Closed by caps, it has edges with more than two faces, or with two in contradicting directions."
_INSIDE_OUT = "Its faces are oriented inwards: turn them."


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredPart:
    """A part and what can be measured of it, in the unit of length of the mesh."""

    number: int  # its label
    name: str  # empty for none
    faces: int  # of the input
    area: float  # of these faces
    volume: float | None  # inside the part closed by caps; None if it cannot be closed
    why_no_volume: str | None  # a sentence, if the volume is None
    centre: FloatArray  # (3,) the centroid of the area
    box: OrientedBox
    neighbours: tuple[Neighbour, ...]  # in the order of their numbers


@dataclass(frozen=True, slots=True, eq=False)
class PartList:
    """The parts in the order of their numbers, and the groups of congruent ones."""

    parts: tuple[MeasuredPart, ...]
    repeats: Repeats


def parts(
    mesh: Mesh, labels: ArrayLike, names: Mapping[int, str] | None = None, *, tolerance: float = TOLERANCE
) -> PartList:
    """The parts of a mesh: size, place, neighbours and repeats.

    Lengths are in the unit of the mesh (``mesh.coordinates.unit``), areas in its square, volumes in its cube. See
    :mod:`segcore.part_list.boxes`, :mod:`segcore.part_list.neighbours` and :mod:`segcore.part_list.repeats`.

    Parameters
    ----------
    labels : (F,) the part 0..K - 1 of every face, such as ``hierarchy.labels(7)`` or ``partition.labels``.
    names : names of parts by label, such as ``partition.names``.
    tolerance : largest deviation of congruent parts from each other, in diagonals of the box of the first one, above 0
        and at most 0.1.

    Raises
    ------
    InvalidParameters
        If there is not one label for each face, a label is left out, the tolerance is outside its range, or the
        mesh is larger than 1e70 or smaller than 1e-70.
    """
    if np.abs(mesh.bounds).max() > _LARGEST or 0.0 < np.ptp(mesh.bounds, axis=0).max() < 1.0 / _LARGEST:
        raise InvalidParameters("The mesh is too large or too small for areas and volumes: use another unit of length.")
    partition, known = partition_of(labels, len(mesh.faces))
    if known != list(range(len(known))):
        missing = next(label for label, number in enumerate(known) if label != number)
        raise InvalidParameters(f"No face has the label {missing}: number the parts 0, 1, 2, ... without gaps.")
    count, surface = len(partition), build_surface(mesh)
    opened = list(open_groups(mesh, group(partition.labels, count)))
    most_normals = min(max(_NORMALS_OF_ALL // count, _LEAST_NORMALS), _MOST_NORMALS)
    boxes = [oriented_box(part.vertices, most_normals) for part in opened]
    areas = group_sums(partition.labels, face_normals_and_areas(mesh.corners)[1], count)
    shapes = [_shape(part, box, area) for part, box, area in zip(opened, boxes, areas.tolist(), strict=True)]
    centres = np.array(
        [box.centre if shape is None else shape.centre for shape, box in zip(shapes, boxes, strict=True)]
    )
    repeats = find_repeats(shapes, tolerance)
    vertices, on_surface = positions(mesh, surface), labels_on(surface, partition.labels)
    beside = neighbours_of_parts(surface, vertices, on_surface, centres)
    volumes = _volumes(closed_groups(vertices, surface.faces, on_surface, count), count)
    faces = partition.face_counts.tolist()
    return PartList(
        tuple(
            MeasuredPart(
                number=part,
                name=(names or {}).get(part, ""),
                faces=faces[part],
                area=float(areas[part]),
                volume=volumes[part][0],
                why_no_volume=volumes[part][1],
                centre=centres[part],
                box=boxes[part],
                neighbours=tuple(beside[part]),
            )
            for part in range(count)
        ),
        repeats,
    )


def _shape(part: Part, box: OrientedBox, area: float) -> PartShape | None:
    """The shape of a part; None if it has no area."""
    return PartShape(part.vertices, part.faces, box) if area > _NO_AREA * box.diagonal**2 else None


def _volumes(closed: Iterator[Part], count: int) -> list[tuple[float | None, str | None]]:
    """The volume of every part closed by caps, or None and the reason."""
    found: list[tuple[float | None, str | None]] = [(None, _NOTHING_LEFT)] * count
    for part in closed:
        volume = _enclosed(part.vertices, part.faces)
        if not part.is_solid:
            found[part.label] = (None, _NOT_MANIFOLD)
        elif volume < 0.0:
            found[part.label] = (None, _INSIDE_OUT)
        else:
            found[part.label] = (volume, None)
    return found


def _enclosed(vertices: FloatArray, faces: IntArray) -> float:
    """The volume inside faces without a border, by the divergence theorem."""
    a, b, c = (vertices - vertices.mean(axis=0))[faces].transpose(1, 0, 2)
    return float(np.einsum("fi,fi->", a, np.cross(b, c)) / 6.0)
