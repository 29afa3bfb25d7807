"""The nearest face to the mirror image of a face, found in a grid of cells."""

from typing import NamedTuple

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.jit.decorators import inner_kernel, kernel
from segcore.threads import in_blocks

CLOSE = 0.1  # distance of an image from its face, in sqrt(area of the face), up to which the two coincide; set by hand
_REACHES = (0.75, 0.25, 4.0)  # distances of images, in the square root of the mean area of a face; set by hand
_MOST_TRIED = 256  # faces that are compared with one image; set by hand
_STEP_I, _STEP_J = 73_856_093, 83_492_791  # odd numbers between the slots of cells that follow each other


class Halves(NamedTuple):
    """The faces of a surface by centre and normal, and a plane {x : normal . x = offset} that divides them."""

    centre: FloatArray  # (F, 3)
    normal: FloatArray  # (F, 3)
    area: FloatArray  # (F,)
    is_first: BoolArray  # (F,)
    far: float  # the distance that counts as much as a difference of normals of 1
    plane: FloatArray  # (4,) normal and offset


class _Cells(NamedTuple):
    """Faces by the cells of a grid, several of which may have the same slot."""

    size: float  # of a cell: twice the distance up to which faces are found
    start: IntArray  # (S + 1,) the faces of slot s are face[start[s]] to face[start[s + 1] - 1]; S is a power of two
    face: IntArray  # (F,)


def close_images(halves: Halves, faces: IntArray, among: IntArray) -> IntArray:
    """(M,) the nearest of some faces to the image of every face (M,), -1 if none is near.

    The distance is that of the centres, with the normals as further coordinates. It is at most four times the square
    root of the mean area, and no image is compared with more than 256 faces. O(F).

    Parameters
    ----------
    among : (N,) the faces to choose from, ascending.
    """
    found = np.full(len(faces), -1, dtype=np.int32)
    mean = float(np.sqrt(halves.area.mean()))
    for reach in _REACHES:
        left = np.flatnonzero(found < 0).astype(np.int32)
        if len(left) and mean > 0.0:
            images = np.full(len(left), -1, dtype=np.int32)
            cells = _in_cells(halves.centre, among, 2.0 * reach * mean)
            in_blocks(_find, len(left), faces[left], cells, halves, images)
            found[left] = images
    return found


@kernel
def _in_cells(centre: FloatArray, faces: IntArray, size: float) -> _Cells:
    slots = 16
    while slots < len(faces):
        slots *= 2
    start = np.zeros(slots + 1, np.int32)
    slot_of = np.empty(len(faces), np.int32)
    for i in range(len(faces)):
        x, y, z = centre[faces[i]]
        slot_of[i] = _slot(_cell(x, size), _cell(y, size), _cell(z, size), slots)
        start[slot_of[i] + 1] += 1
    for s in range(slots):
        start[s + 1] += start[s]
    sorted_faces = np.empty(len(faces), np.int32)
    fill = start[:-1].copy()
    for i in range(len(faces)):
        sorted_faces[fill[slot_of[i]]] = faces[i]
        fill[slot_of[i]] += 1
    return _Cells(size, start, sorted_faces)


@inner_kernel
def _cell(coordinate, size):  # type: ignore[no-untyped-def]
    return int(np.floor(coordinate / size))


@inner_kernel
def _slot(i, j, k, slots):  # type: ignore[no-untyped-def]
    """The slot of a cell; cells that follow each other along the last axis have slots that do so."""
    return (i * _STEP_I + j * _STEP_J + k) & (slots - 1)


@kernel
def _find(start, end, faces, cells, halves, found):  # type: ignore[no-untyped-def]
    px, py, pz, offset = halves.plane
    slots = len(cells.start) - 1
    size = cells.size
    radius = 0.5 * size
    for m in range(start, end):
        x, y, z = halves.centre[faces[m]]
        nx, ny, nz = halves.normal[faces[m]]
        twice = 2.0 * (x * px + y * py + z * pz - offset)
        x, y, z = x - twice * px, y - twice * py, z - twice * pz
        twice = 2.0 * (nx * px + ny * py + nz * pz)
        nx, ny, nz = nx - twice * px, ny - twice * py, nz - twice * pz
        nearest = radius * radius
        best = -1
        tried = 0
        for i in range(_cell(x - radius, size), _cell(x + radius, size) + 1):
            for j in range(_cell(y - radius, size), _cell(y + radius, size) + 1):
                for k in range(_cell(z - radius, size), _cell(z + radius, size) + 1):
                    slot = _slot(i, j, k, slots)
                    for p in range(cells.start[slot], cells.start[slot + 1]):
                        tried += 1
                        if tried > _MOST_TRIED:
                            break
                        g = cells.face[p]
                        u, v, w = halves.centre[g, 0] - x, halves.centre[g, 1] - y, halves.centre[g, 2] - z
                        away = u * u + v * v + w * w
                        if away > nearest:
                            continue
                        u, v, w = halves.normal[g, 0] - nx, halves.normal[g, 1] - ny, halves.normal[g, 2] - nz
                        away += halves.far * halves.far * (u * u + v * v + w * w)
                        if away < nearest or (away == nearest and (best < 0 or g < best)):
                            nearest = away
                            best = g
        if tried <= _MOST_TRIED:
            found[m] = best


@kernel
def coinciding_area(start, end, halves, image):  # type: ignore[no-untyped-def]
    """(2,) the area of some faces whose centres coincide with those of their images (F,), and of all of them."""
    px, py, pz, offset = halves.plane
    areas = np.zeros(2)
    for f in range(start, end):
        x, y, z = halves.centre[f]
        twice = 2.0 * (x * px + y * py + z * pz - offset)
        u, v, w = halves.centre[image[f]]
        squared = (x - twice * px - u) ** 2 + (y - twice * py - v) ** 2 + (z - twice * pz - w) ** 2
        areas[1] += halves.area[f]
        if squared <= CLOSE * CLOSE * halves.area[f]:
            areas[0] += halves.area[f]
    return areas
