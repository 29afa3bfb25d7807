"""Border loops that one cap closes together, as the two rings where the wall of a pipe is cut."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.spatial import KDTree

from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray
from segcore.io.parts.triangulation import Filling, fill_flat, fill_ribbon
from segcore.mesh import face_normals_and_areas

Inside: TypeAlias = Callable[[FloatArray], BoolArray]  # (N,) whether points (N, 3) are inside the whole model

_BRIDGES = 8  # that are tried between two loops, shortest first; set by hand: the first is nearly always the best
_MOST_LOOPS = 128  # of a part; a part with more has holes all over, which are closed one by one
_CANDIDATES = 16  # loops of which the distance is measured, those with the nearest boxes
_PARTNERS = 4  # loops that are tried as the other side of a bore, nearest first; set by hand
_SAMPLES = 12  # the largest triangles of a cap, of which the centroids are tested; set by hand
_CLEARLY = 0.25  # by which a larger share of a joined cap must be inside; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class Cap:
    """A loop with the triangles that fill it."""

    loop: IntArray  # (N,) vertices; the ends of a bridge between joined loops occur twice
    triangles: LongArray  # (N - 2, 3) positions in the loop


@dataclass(frozen=True, slots=True, eq=False)
class _Measured(Cap):
    is_plain: bool
    area: float
    direction: FloatArray  # (3,) the vector area: along the normal of a flat loop
    box: FloatArray  # (2, 3) the lowest and the highest coordinates


def caps_of(vertices: FloatArray, loops: list[IntArray], is_inside: Inside) -> Sequence[Cap]:
    """Fill every border loop, and those together that belong together.

    The cap of a loop around the bore of a pipe would close the bore: it is outside the model. Two loops in opposite
    directions are joined by a bridge, an edge that is walked along in both directions, if the cap of both is smaller
    than the sum of their own caps, and clearly more of it is inside.
    """
    if len(loops) > _MOST_LOOPS:
        return [Cap(loop, fill_flat(vertices[loop], loop).triangles) for loop in loops]
    caps = sorted((_cap(vertices, loop) for loop in loops), key=lambda cap: cap.area)
    done: list[Cap] = []
    while caps:
        cap = caps.pop(0)
        found = [
            (joint.area - caps[place].area, place, joint)
            for place in _near_opposites(vertices, cap, caps)
            if (joint := _joined(vertices, cap, caps[place], is_inside))
        ]
        if found:
            _, place, joint = min(found, key=lambda candidate: candidate[:2])
            caps[place] = joint
        else:
            done.append(cap)
    return done


def _cap(vertices: FloatArray, loop: IntArray, filling: Filling | None = None) -> _Measured:
    points = vertices[loop]
    centred = points - points.mean(axis=0)
    direction = 0.5 * np.cross(centred, np.roll(centred, -1, axis=0)).sum(axis=0)
    box = np.stack([points.min(axis=0), points.max(axis=0)])
    filled = filling or fill_flat(points, loop)
    area = float(face_normals_and_areas(points[filled.triangles])[1].sum())
    return _Measured(loop, filled.triangles, filled.is_plain, area, direction, box)


def _near_opposites(vertices: FloatArray, cap: _Measured, others: list[_Measured]) -> list[int]:
    """The places of loops in the opposite direction that are closer than the extent of the cap, nearest first."""
    if not others:
        return []
    boxes = np.stack([other.box for other in others])
    reach = float(np.linalg.norm(cap.box[1] - cap.box[0]))
    gap = np.maximum(cap.box[0] - boxes[:, 1], boxes[:, 0] - cap.box[1]).max(axis=1)
    is_opposite = np.stack([other.direction for other in others]) @ cap.direction < 0
    distance = {
        place: float(_nearest_corners(vertices, cap.loop, others[place].loop)[0].min())
        for place in np.argsort(np.where(is_opposite, gap, np.inf), kind="stable")[:_CANDIDATES].tolist()
        if is_opposite[place] and gap[place] < reach
    }
    return sorted((place for place in distance if distance[place] < reach), key=distance.__getitem__)[:_PARTNERS]


def _nearest_corners(vertices: FloatArray, loop: IntArray, other: IntArray) -> tuple[FloatArray, LongArray]:
    """(N,) the distance of every corner of a loop from the nearest one of another loop, and (N,) which one that is."""
    distance, corner = KDTree(vertices[other]).query(vertices[loop])
    return np.asarray(distance), np.asarray(corner)


def _joined(vertices: FloatArray, cap: _Measured, other: _Measured, is_inside: Inside) -> _Measured | None:
    """The cap of both loops, or None if their own caps are better."""
    joint = _cap_of_both(vertices, cap, other)
    if joint is None or joint.area >= cap.area + other.area:
        return None
    own = _share_inside(vertices, [cap, other], is_inside)
    return joint if _share_inside(vertices, [joint], is_inside) > own + _CLEARLY else None


def _cap_of_both(vertices: FloatArray, cap: Cap, other: Cap) -> _Measured | None:
    """The cap in a plane with the shortest bridge that allows one, else a ribbon with the shortest bridge."""
    distance, ends = _nearest_corners(vertices, cap.loop, other.loop)
    loops = [
        _bridged(other.loop, int(ends[end]), cap.loop, end)
        for end in np.argsort(distance, kind="stable")[:_BRIDGES].tolist()
    ]
    for loop in loops:
        joint = _cap(vertices, loop)
        if joint.is_plain:
            return joint
    if distance.min() == 0:  # the loops touch
        return None
    filling = fill_ribbon(vertices[loops[0]], len(other.loop))
    return _cap(vertices, loops[0], filling) if filling else None


def _share_inside(vertices: FloatArray, caps: Sequence[Cap], is_inside: Inside) -> float:
    """The share of the area of the largest triangles of caps whose centroids are inside the model."""
    corners = np.concatenate([vertices[cap.loop[cap.triangles]] for cap in caps])
    areas = face_normals_and_areas(corners)[1]
    largest = np.argsort(-areas, kind="stable")[:_SAMPLES]
    weights = areas[largest]
    return float((weights * is_inside(corners[largest].mean(axis=1))).sum() / (weights.sum() or 1.0))


def _bridged(loop: IntArray, at: int, other: IntArray, end: int) -> IntArray:
    """One loop along both, with a bridge from corner ``at`` of one to corner ``end`` of the other and back."""
    bridge = int(loop[at] != other[end])  # if the loops touch there, there is no need for one
    return np.concatenate([np.roll(loop, -at), loop[at : at + bridge], np.roll(other, -end), other[end : end + bridge]])
