"""The rigid motion, or reflection and motion, that maps one part to another, whatever their meshing.

Candidates are rotations that map the principal axes of the area, or the axes of the boxes, to each other in any way,
and the rotation that changes nothing. If principal axes are not determined, as for a wheel, rotations about the
remaining axis, or in all directions, are further ones. The best are refined by Gauss-Newton steps that move points of
the one part onto the planes of the nearest faces of the other.

References
----------
Y. Chen, G. Medioni, Object modelling by registration of multiple range images, Image and Vision Computing 10(3), 1992.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np

from segcore.arrays import FloatArray, transformed
from segcore.part_list.directions import about_axis, spread_rotations, turned_by
from segcore.part_list.part_shape import PartShape

# All set by hand.
_CLEAR = 0.1  # share of the tolerance up to which a fit is not improved
_BETTER = 0.25  # ratio of deviations from which a mirrored fit is preferred to one that is not
_SAME_SPREAD = 0.1  # relative difference of spreads up to which the axes between them are not determined
_PROBES = 8  # every eighth point is used to score candidates
_FITTED = 2  # every second one to refine them
_TRIED, _REFINED = 8, 4  # candidates whose deviations are measured, and of these are refined
_STEPS = 8  # of a refinement
_EXACT = 1e-6  # deviation in sizes from which a candidate is not refined
_NEAR = 3.0  # times the limit: larger deviations of some points are not refined any further
_CONVERGED = 1e-10  # step, in sizes
_TURN = 0.005  # deviation in sizes that weighs as much as half a turn, so that parts are turned as little as possible
_DIGITS = 6  # of deviations in sizes: of equal fits the one that turns less is taken
_ABOUT, _ALL = 120, 1000  # rotations about an axis, by 3 degrees, and in all directions, by about 20
_IDENTITY = np.eye(3)


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A map of a part to another one: x to rotation x + shift, around their centres."""

    rotation: FloatArray  # (3, 3) orthogonal, with the determinant -1 if it mirrors
    shift: FloatArray  # (3,)
    largest: float  # deviation, in units of the mesh, of points of either part from the other one
    mean: float  # the root of the mean square of the deviations

    @property
    def is_mirrored(self) -> bool:
        """Whether the map reverses orientation."""
        return bool(np.linalg.det(self.rotation) < 0.0)


def congruence(first: PartShape, other: PartShape, tolerance: float) -> Fit | None:
    """The best map of one part to another, or None if all deviate too much.

    Parameters
    ----------
    tolerance : largest deviation, in sizes of the first part.
    """
    limit = tolerance * first.size
    best: Fit | None = None
    for is_mirrored in (False, True):
        for candidates in _candidates(first, other, is_mirrored):
            fit = _best(first, other, candidates, limit)
            if fit is not None and (best is None or fit.largest < _weight(fit, best) * best.largest):
                best = fit
            if best is not None and best.largest <= _CLEAR * limit:
                return best
    return best if best is not None and best.largest <= limit else None


def _weight(fit: Fit, best: Fit) -> float:
    return _BETTER if fit.is_mirrored != best.is_mirrored else 1.0


def in_order(first: PartShape, other: PartShape, tolerance: float) -> Fit | None:
    """The map between parts with the same faces in the same order, as copies in a file are; None for any other.

    It is taken only if the vertices deviate by a tenth of the tolerance at most.

    The sum of the squared distances of the vertices is minimal.

    References
    ----------
    K. S. Arun, T. S. Huang, S. D. Blostein, Least-squares fitting of two 3-D point sets, PAMI 9(5), 1987.
    """
    limit = _CLEAR * tolerance * first.size
    a, b = first.vertices, other.vertices
    if a.shape != b.shape or first.faces.shape != other.faces.shape:
        return None
    if not np.array_equal(np.sort(first.faces, axis=1), np.sort(other.faces, axis=1)):
        return None
    middle_a, middle_b = a.mean(axis=0), b.mean(axis=0)
    u, _, vt = np.linalg.svd(np.einsum("vi,vj->ij", b - middle_b, a - middle_a))
    found = []
    for sign in (1.0, -1.0):
        rotation = u @ np.diag([1.0, 1.0, sign * np.sign(np.linalg.det(u @ vt))]) @ vt
        shift = middle_b - rotation @ middle_a
        away = np.linalg.norm(transformed(a, rotation) + shift - b, axis=1)
        found.append(Fit(rotation, shift, float(away.max()), float(np.sqrt(np.mean(away**2)))))
    proper, mirrored = found
    best = mirrored if mirrored.largest < _BETTER * proper.largest and proper.largest > _CLEAR * limit else proper
    return best if best.largest <= limit else None


def _candidates(first: PartShape, other: PartShape, is_mirrored: bool) -> Iterator[FloatArray]:
    """Sets (C, 3, 3) of rotations, the more expensive ones last."""
    flips = [np.diag(signs) for signs in product((1.0, -1.0), repeat=3)]
    turns = [flip @ _IDENTITY[list(order)] for order in permutations(range(3)) for flip in flips]
    plain = [_IDENTITY, *(np.diag(1.0 - 2.0 * row) for row in _IDENTITY)]
    principal = [other.axes.T @ flip @ first.axes for flip in flips]
    boxes = [other.box.axes.T @ turn @ first.box.axes for turn in turns]
    yield _of_kind(np.array([*plain, *principal, *boxes]), is_mirrored)
    low, middle, high = first.spread
    is_low_free, is_high_free = middle - low <= _SAME_SPREAD * high, high - middle <= _SAME_SPREAD * high
    if is_low_free and is_high_free:
        yield spread_rotations(_ALL) * (-1.0 if is_mirrored else 1.0)
    elif is_low_free or is_high_free:
        axis = first.axes[2 if is_low_free else 0]
        starts = _of_kind(np.array(principal), is_mirrored)
        ahead = starts @ axis @ (starts[0] @ axis) > 0.0  # two of each: half a turn about the axis apart
        start = np.stack([starts[ahead][0], starts[~ahead][0]])
        yield np.einsum("aij,bjk->abik", start, about_axis(axis, _ABOUT)).reshape(-1, 3, 3)


def _of_kind(rotations: FloatArray, is_mirrored: bool) -> FloatArray:
    """Those with the determinant -1 or 1."""
    return rotations[(np.linalg.det(rotations) < 0.0) == is_mirrored]


def _best(first: PartShape, other: PartShape, candidates: FloatArray, limit: float) -> Fit | None:
    """The best fit after the most promising candidates have been refined; None if none of them is near the limit."""
    probes = first.points[::_PROBES]
    images = np.einsum("cij,pj->cpi", candidates, probes)
    score = other.distance.roughly(images).mean(axis=1) / first.size
    chosen = candidates[np.argsort(score + _TURN * _turns(candidates), kind="stable")[:_TRIED]]

    def deviation(motion: Motion) -> float:
        away = other.distance.quickly(transformed(probes, motion[0]) + motion[1])
        return round(float(away.max()) / first.size, _DIGITS)

    motions = sorted(((rotation, np.zeros(3)) for rotation in chosen), key=deviation)
    if deviation(motions[0]) <= _EXACT:
        return _measured(first, other, motions[0])
    rough = [_refined(first, other, motion, _STEPS, is_exact=False) for motion in motions[:_REFINED]]
    near = min([motions[0], *rough], key=deviation)
    if deviation(near) * first.size > _NEAR * limit:
        return None
    exact = _refined(first, other, near, _STEPS, is_exact=True)
    fits = [_measured(first, other, motion) for motion in (motions[0], exact)]
    return min(fits, key=lambda fit: round(fit.largest / first.size, _DIGITS))  # the first of equal ones


def _turns(rotations: FloatArray) -> FloatArray:
    """(C,) the angles of rotations (C, 3, 3), or of those that follow a point reflection, over pi."""
    trace = np.trace(rotations, axis1=1, axis2=2) * np.linalg.det(rotations)
    return np.asarray(np.arccos(np.clip(0.5 * (trace - 1.0), -1.0, 1.0)) / np.pi)


Motion = tuple[FloatArray, FloatArray]  # a rotation and a shift


def _refined(first: PartShape, other: PartShape, motion: Motion, steps: int, is_exact: bool) -> Motion:
    """The motion after Gauss-Newton steps; directions in which the planes leave it free do not change."""
    rotation, shift = motion
    points, size = first.points[::_FITTED], first.size
    planes = other.distance.planes if is_exact else other.distance.rough_planes
    for _ in range(steps):
        images = transformed(points, rotation) + shift
        on_plane, normals = planes(images)
        heights = np.einsum("pi,pi->p", on_plane - images, normals)
        columns = np.concatenate([np.cross(images, normals) / size, normals], axis=1)
        step = np.linalg.lstsq(columns, heights, rcond=1e-6)[0]
        turned = turned_by(step[:3] / size)
        rotation, shift = turned @ rotation, turned @ shift + step[3:]
        if np.abs(step).max() <= _CONVERGED * size:
            break
    return rotation, shift


def _measured(first: PartShape, other: PartShape, motion: Motion) -> Fit:
    """The motion with its deviations, from points of either part to the other one."""
    u, _, vt = np.linalg.svd(motion[0])
    rotation, shift = u @ vt, motion[1]
    there = other.distance(transformed(first.points, rotation) + shift)
    back = first.distance(transformed(other.points - shift, rotation.T))
    away = np.concatenate([there, back])
    return Fit(rotation, shift, float(away.max()), float(np.sqrt(np.mean(away**2))))
