"""A view of a mesh from any side: the visible parts, their numbers in the picture, and what is seen at a pixel."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.ndimage import distance_transform_edt, maximum_position

from segcore.arrays import IntArray
from segcore.errors import InvalidParameters
from segcore.io.palette import SegmentColors
from segcore.io.picture import SAMPLES, ByteArray, Seen, seen_from, shaded
from segcore.io.view.digits import number_stamp
from segcore.mesh import Mesh

_PIXELS_PER_DOT = 256  # a dot of a digit is one pixel for each so many pixels of the picture; set by hand
_WHITE = 255


@dataclass(frozen=True, slots=True)
class VisiblePart:
    """A part in a picture. Pixels are counted from 0 at the top left."""

    number: int
    pixels: int  # in which it is seen
    x: int  # column of the pixel of the part that is farthest from its outline
    y: int  # row
    is_numbered: bool  # False if its number would cover that of a larger part


@dataclass(frozen=True, slots=True)
class View:
    """A mesh as it is seen from one side."""

    seen: Seen
    labels: IntArray  # (F,) the part of each face

    @property
    def size(self) -> int:
        """Width and height in pixels."""
        return len(self.seen.face) // SAMPLES

    def face_at(self, x: int, y: int) -> int | None:
        """Return the face that is seen at a pixel, None for the background.

        Raises
        ------
        InvalidParameters
            If there is no such pixel.
        """
        if not (0 <= x < self.size and 0 <= y < self.size):
            raise InvalidParameters(f"The picture has no pixel ({x}, {y}): x and y are 0 to {self.size - 1}.")
        samples = self.seen.face[SAMPLES * y : SAMPLES * (y + 1), SAMPLES * x : SAMPLES * (x + 1)].ravel()
        shown = samples[samples >= 0]
        return int(shown[0]) if len(shown) else None

    def faces_between(self, points: list[tuple[int, int]]) -> list[int]:
        """Return the faces that are seen along the straight lines from point to point, each once, in order."""
        for x, y in points:
            self.face_at(x, y)  # refuses a pixel that does not exist
        runs = [self._along(start, end) for start, end in pairwise(points)]
        faces = np.concatenate(runs) if runs else np.zeros(0, dtype=np.int32)
        every, first = np.unique(faces, return_index=True)
        return [int(face) for face in every[np.argsort(first)] if face >= 0]

    def _along(self, start: tuple[int, int], end: tuple[int, int]) -> IntArray:
        """(N,) the faces at the samples along a straight line between two pixels, -1 for the background."""
        count = SAMPLES * max(abs(end[0] - start[0]), abs(end[1] - start[1])) + 1
        columns, rows = np.rint(np.linspace(start, end, count) * SAMPLES).astype(int).T
        return self.seen.face[rows, columns]

    def visible_parts(self) -> list[VisiblePart]:
        """Return the parts that are seen, those with the most room for a number first."""
        label = self.seen.labels(self.labels)[::SAMPLES, ::SAMPLES]
        framed = np.pad(label, 1, constant_values=-1)
        inner = framed[1:-1, 1:-1]
        outline = inner < 0
        for axis in (0, 1):
            for step in (1, -1):
                outline |= inner != np.roll(framed, step, axis)[1:-1, 1:-1]
        room = distance_transform_edt(~outline)
        counts = np.bincount(label[label >= 0]) if (label >= 0).any() else np.zeros(0, dtype=int)
        numbers = np.flatnonzero(counts)
        places = maximum_position(room, label, numbers) if len(numbers) else []
        order = sorted(range(len(numbers)), key=lambda k: (-room[places[k]], -counts[numbers[k]]))
        covered = np.zeros(label.shape, dtype=bool)
        parts = []
        for k in order:
            number, (y, x) = int(numbers[k]), places[k]
            box = self._box(number, int(x), int(y))
            parts.append(VisiblePart(number, int(counts[number]), int(x), int(y), not covered[box].any()))
            if parts[-1].is_numbered:
                covered[box] = True
        return parts

    def numbered(self, part_colors: SegmentColors | None = None) -> ByteArray:
        """(size, size, 4) the picture on white, with the numbers of the parts in it."""
        pixels = shaded(self.seen, self.labels, part_colors)
        opacity = pixels[..., 3:] / _WHITE
        pixels[..., :3] = np.rint(pixels[..., :3] * opacity + _WHITE * (1 - opacity)).astype(np.uint8)
        pixels[..., 3] = _WHITE
        for part in self.visible_parts():
            if part.is_numbered:
                rows, columns = box = self._box(part.number, part.x, part.y)
                stamp = number_stamp(part.number, self._scale)
                pixels[box] = stamp[: rows.stop - rows.start, : columns.stop - columns.start]
        return pixels

    @property
    def _scale(self) -> int:
        return max(1, round(self.size / _PIXELS_PER_DOT))

    def _box(self, number: int, x: int, y: int) -> tuple[slice, slice]:
        """Return the rows and columns of the number of a part, around a pixel and inside the picture."""
        height, width, _ = number_stamp(number, self._scale).shape
        top = min(max(y - height // 2, 0), max(self.size - height, 0))
        left = min(max(x - width // 2, 0), max(self.size - width, 0))
        return slice(top, min(top + height, self.size)), slice(left, min(left + width, self.size))


def view_of(mesh: Mesh, labels: IntArray, size: int, azimuth: float, elevation: float) -> View:
    """Return a view of a mesh; parameters as of :func:`segcore.io.draw`."""
    return View(seen_from(mesh, size, azimuth, elevation), labels)
