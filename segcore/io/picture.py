"""Pictures of segmentations, rendered on the CPU, and a PNG writer."""

import struct
import zlib
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import FloatArray, IntArray, transformed
from segcore.coordinates import Coordinates
from segcore.io.palette import SegmentColors, segment_colors
from segcore.jit.decorators import kernel
from segcore.mesh import Mesh, face_normals_and_areas

ByteArray = np.ndarray[tuple[int, ...], np.dtype[np.uint8]]

# The look of the pictures, set by hand.
SAMPLES = 2  # per pixel in each direction
_MARGIN = 0.04  # free border, as a fraction of the width of the picture
_CREASE = np.cos(np.radians(40))  # faces that meet at a larger angle are not shaded smoothly
_KEY = np.array([0.35, 0.75, 0.56])  # direction to the key light: right, up, towards the viewer
_AMBIENT, _HEADLIGHT, _KEY_LIGHT = 0.30, 0.28, 0.52  # shares of the brightness; the headlight is at the viewer
_LINE = 0.35  # brightness of the lines between segments

_BACKGROUND = -1  # in place of a label
_SHORTEST = 1e-12  # length of a mean normal, below which it has no direction and is not normalized
_CLEAREST = 1e-6  # opacity of a pixel without samples, whose colour does not matter
_PNG_LEVEL = 9  # pictures are small: the best compression of zlib


@dataclass(frozen=True, slots=True)
class Seen:
    """What the samples of a picture of a mesh show; R is SAMPLES times the size of the picture."""

    face: IntArray  # (R, R) the nearest face, -1 for the background
    light: FloatArray  # (R, R) its brightness

    def labels(self, labels: IntArray) -> IntArray:
        """(R, R) the segment at each sample, -1 for the background, from the segment of each face."""
        return np.where(self.face == _BACKGROUND, _BACKGROUND, labels[self.face])


def draw(
    mesh: Mesh,
    labels: IntArray,
    size: int = 512,
    azimuth: float = 30.0,
    elevation: float = 20.0,
    *,
    part_colors: SegmentColors | None = None,
) -> ByteArray:
    """Draw a mesh in the colours of its segments, with dark lines between them.

    Parameters
    ----------
    labels : (F,) the segment of each face.
    size : width and height in pixels.
    azimuth, elevation : direction to the viewer in degrees: about the vertical axis, from the front of the mesh (+z, or
        -y if z points up) to its +x, and above the horizontal plane.
    part_colors : colours of segments by label, in place of the fixed ones.

    Returns
    -------
    (size, size, 4) uint8, red, green, blue and opacity: an orthographic view of the whole mesh, upright.
    """
    return shaded(seen_from(mesh, size, azimuth, elevation), labels, part_colors)


def seen_from(mesh: Mesh, size: int, azimuth: float, elevation: float) -> Seen:
    """Return which faces are seen in a picture of a mesh; parameters as of :func:`draw`."""
    upright = Coordinates(up=mesh.coordinates.shown_up).rotation_to("y")
    view = transformed(_view(azimuth, elevation), upright.T)
    seen = transformed(np.clip(mesh.vertices, *mesh.bounds), view)
    used = seen[mesh.is_used]
    low, high = used.min(axis=0), used.max(axis=0)
    resolution = size * SAMPLES
    scale = resolution * (1 - 2 * _MARGIN) / max(float((high - low)[:2].max()), float(np.finfo(float).tiny))
    screen = (seen - 0.5 * (low + high)) * scale
    screen[:, :2] = screen[:, :2] * [1, -1] + 0.5 * resolution
    normals = _corner_normals(mesh.faces, face_normals_and_areas(mesh.corners)[0], len(mesh.vertices))
    every = np.arange(len(mesh.faces), dtype=np.int32)
    return Seen(*_rasterize(screen, mesh.faces, every, transformed(normals, view), resolution))


def _view(azimuth: float, elevation: float) -> FloatArray:
    """(3, 3) rotation whose rows are the directions right, up and towards the viewer."""
    a, e = np.radians(azimuth), np.radians(elevation)
    towards = np.array([np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)])
    right = np.array([np.cos(a), 0.0, -np.sin(a)])
    return np.stack([right, np.cross(towards, right), towards])


def shaded(seen: Seen, labels: IntArray, part_colors: SegmentColors | None = None) -> ByteArray:
    """Return the picture of segments that are seen, as :func:`draw` does."""
    label, light = seen.labels(labels), seen.light
    size = len(label) // SAMPLES
    covered = label != _BACKGROUND
    colors = segment_colors(int(label.max()) + 1, part_colors)[label] if covered.any() else np.zeros((*label.shape, 3))
    border = np.zeros(label.shape, dtype=bool)
    for axis in (0, 1):
        behind = np.roll(label, 1, axis)
        border |= (label != behind) & covered & (behind != _BACKGROUND)
    shade = np.where(border, _LINE, 1.0) * light
    image = np.concatenate(
        [np.minimum(colors * shade[..., None], 1.0) * covered[..., None], covered[..., None]], axis=2
    )
    image = image.reshape(size, SAMPLES, size, SAMPLES, 4).mean(axis=(1, 3))
    image[..., :3] /= np.maximum(image[..., 3:], _CLEAREST)
    pixels: ByteArray = np.rint(255 * image).astype(np.uint8)
    return pixels


@kernel
def _corner_normals(faces: IntArray, normals: FloatArray, vertex_count: int) -> FloatArray:
    """(F, 3, 3) at each corner the mean normal of the faces at its vertex that are within the crease angle."""
    start = np.zeros(vertex_count + 1, np.int64)
    for f in range(len(faces)):
        for k in range(3):
            start[faces[f, k] + 1] += 1
    for v in range(vertex_count):
        start[v + 1] += start[v]
    fill = start[:-1].copy()
    around = np.empty(3 * len(faces), np.int32)
    for f in range(len(faces)):
        for k in range(3):
            around[fill[faces[f, k]]] = f
            fill[faces[f, k]] += 1
    result = np.empty((len(faces), 3, 3))
    for f in range(len(faces)):
        n = normals[f]
        for k in range(3):
            x, y, z = 0.0, 0.0, 0.0
            v = faces[f, k]
            for p in range(start[v], start[v + 1]):
                m = normals[around[p]]
                if n[0] * m[0] + n[1] * m[1] + n[2] * m[2] > _CREASE:
                    x, y, z = x + m[0], y + m[1], z + m[2]
            length = max(np.sqrt(x * x + y * y + z * z), _SHORTEST)
            result[f, k, 0], result[f, k, 1], result[f, k, 2] = x / length, y / length, z / length
    return result


@kernel
def _rasterize(
    screen: FloatArray, faces: IntArray, labels: IntArray, normals: FloatArray, resolution: int
) -> tuple[IntArray, FloatArray]:
    """The label, -1 for the background, and the brightness of the nearest face at each sample."""
    label = np.full((resolution, resolution), _BACKGROUND, np.int32)
    light = np.zeros((resolution, resolution))
    depth = np.full((resolution, resolution), -np.inf)
    for f in range(len(faces)):
        a, b, c = screen[faces[f, 0]], screen[faces[f, 1]], screen[faces[f, 2]]
        doubled = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if doubled == 0.0:
            continue
        left = max(int(np.floor(min(a[0], b[0], c[0]))), 0)
        right = min(int(np.ceil(max(a[0], b[0], c[0]))), resolution - 1)
        top = max(int(np.floor(min(a[1], b[1], c[1]))), 0)
        bottom = min(int(np.ceil(max(a[1], b[1], c[1]))), resolution - 1)
        for row in range(top, bottom + 1):
            for column in range(left, right + 1):
                x, y = column + 0.5, row + 0.5
                u = ((b[0] - x) * (c[1] - y) - (c[0] - x) * (b[1] - y)) / doubled
                v = ((c[0] - x) * (a[1] - y) - (a[0] - x) * (c[1] - y)) / doubled
                w = 1.0 - u - v
                if u < 0.0 or v < 0.0 or w < 0.0:
                    continue
                z = u * a[2] + v * b[2] + w * c[2]
                if z <= depth[row, column]:
                    continue
                depth[row, column] = z
                label[row, column] = labels[f]
                n = u * normals[f, 0] + v * normals[f, 1] + w * normals[f, 2]
                length = max(np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), _SHORTEST)
                # A face seen from behind is lit as its other side is.
                side = 1.0 if n[2] >= 0.0 else -1.0
                key = max(0.0, side * (_KEY[0] * n[0] + _KEY[1] * n[1] + _KEY[2] * n[2]) / length)
                light[row, column] = _AMBIENT + _HEADLIGHT * abs(n[2]) / length + _KEY_LIGHT * key
    return label, light


def write_png(target: BinaryIO, pixels: NDArray[np.uint8]) -> None:
    """Write (height, width, 4) uint8 pixels as PNG, the top row first."""
    height, width, _ = pixels.shape
    unfiltered = np.zeros((height, 1 + 4 * width), dtype=np.uint8)
    unfiltered[:, 1:] = pixels.reshape(height, -1)
    target.write(b"\x89PNG\r\n\x1a\n")
    _write_chunk(target, b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0))
    _write_chunk(target, b"IDAT", zlib.compress(unfiltered.tobytes(), _PNG_LEVEL))
    _write_chunk(target, b"IEND", b"")


def _write_chunk(target: BinaryIO, kind: bytes, data: bytes) -> None:
    target.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))
