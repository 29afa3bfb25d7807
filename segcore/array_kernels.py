"""Kernels on arrays that several stages share. :mod:`segcore.arrays` has none, so that it is imported without numba."""

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import FloatArray, IntArray, LongArray, pair_keys
from segcore.jit.decorators import inner_kernel, kernel
from segcore.threads import in_blocks, sums_of_blocks

_DENSE = 4  # indices for each pair, up to which pairs are counted by their smaller index; set by hand
_FEW = 32  # pairs of one smaller index up to which they are sorted by insertion; set by hand


def distinct_pairs(pairs: NDArray[np.integer]) -> tuple[IntArray, LongArray]:
    """The different ones (D, 2) of pairs (P, 2) of indices in any order, and (P,) which of them each is.

    The smaller index of a pair comes first; the pairs are sorted.
    """
    count = int(pairs.max(initial=0)) + 1
    if count <= _DENSE * len(pairs):
        return _distinct_pairs(pairs, count)
    keys, which = np.unique(pair_keys(pairs, count), return_inverse=True)
    return np.stack([keys // count, keys % count], axis=1).astype(np.int32), which


@kernel
def _distinct_pairs(pairs, count):  # type: ignore[no-untyped-def]
    """Pairs sorted by counting their smaller indices, and by insertion or merging where these are equal."""
    start = np.zeros(count + 1, np.int64)
    for p in range(len(pairs)):
        start[min(pairs[p, 0], pairs[p, 1]) + 1] += 1
    for low in range(count):
        start[low + 1] += start[low]
    fill = start[:-1].copy()
    high = np.empty(len(pairs), np.int32)
    which = np.empty(len(pairs), np.int64)  # the pairs in their order, until their numbers are known
    for p in range(len(pairs)):
        low = min(pairs[p, 0], pairs[p, 1])
        place = fill[low]
        fill[low] += 1
        high[place], which[place] = max(pairs[p, 0], pairs[p, 1]), p
    distinct = np.empty((len(pairs), 2), np.int32)
    number = np.empty(len(pairs), np.int64)
    used = 0
    for low in range(count):
        begin, end = start[low], start[low + 1]
        if end - begin > _FEW:
            far_ends, found = high[begin:end].copy(), which[begin:end].copy()
            order = ascending(far_ends.astype(np.float64))
            for p in range(end - begin):
                high[begin + p], which[begin + p] = far_ends[order[p]], found[order[p]]
        else:
            for p in range(begin + 1, end):
                far, pair, q = high[p], which[p], p
                while q > begin and high[q - 1] > far:
                    high[q], which[q] = high[q - 1], which[q - 1]
                    q -= 1
                high[q], which[q] = far, pair
        for p in range(begin, end):
            if p == begin or high[p] != high[p - 1]:
                distinct[used, 0], distinct[used, 1] = low, high[p]
                used += 1
            number[which[p]] = used - 1
    return distinct[:used].copy(), number


@inner_kernel
def assign(target, values):  # type: ignore[no-untyped-def]
    """``target[:] = values`` of one dimension; assignments of arrays to slices take long to compile."""
    for i in range(len(values)):
        target[i] = values[i]


@kernel
def ascending(values: FloatArray) -> IntArray:
    """(N,) the order of finite numbers (N,), equal ones as they come: a stable sort by digits of 11 bits. O(N)."""
    count = len(values)
    sign = np.uint64(1) << np.uint64(63)
    keys = (values + 0.0).view(np.uint64)  # 0.0 and -0.0 become equal
    for i in range(count):
        keys[i] = ~keys[i] if keys[i] & sign else keys[i] | sign
    order = np.arange(count).astype(np.int32)
    other_keys, other_order = np.empty_like(keys), np.empty_like(order)
    for digit in range(6):
        shift = np.uint64(11 * digit)
        start = np.zeros(2049, dtype=np.int32)
        for i in range(count):
            start[((keys[i] >> shift) & np.uint64(2047)) + 1] += 1
        if count == 0 or start[((keys[0] >> shift) & np.uint64(2047)) + 1] == count:
            continue  # all have the same digit
        for k in range(2048):
            start[k + 1] += start[k]
        for i in range(count):
            k = (keys[i] >> shift) & np.uint64(2047)
            other_keys[start[k]] = keys[i]
            other_order[start[k]] = order[i]
            start[k] += 1
        keys, other_keys = other_keys, keys
        order, other_order = other_order, order
    return order


@kernel
def members_by_group(group: IntArray, count: int) -> tuple[IntArray, LongArray]:
    """(N,) the members of groups 0..count - 1, by group and ascending in each, and (count + 1,) where each begins."""
    start = np.zeros(count + 1, dtype=np.int64)
    for i in range(len(group)):
        start[group[i] + 1] += 1
    for k in range(count):
        start[k + 1] += start[k]
    free = start[:count].copy()
    members = np.empty(len(group), dtype=np.int32)
    for i in range(len(group)):
        members[free[group[i]]] = i
        free[group[i]] += 1
    return members, start


@kernel
def dot(x: FloatArray, y: FloatArray) -> float:
    """The inner product of two vectors (N,), added in an order that depends on N alone.

    ``numpy.dot`` and ``@`` leave the order to BLAS, whose result for more than 10,000 numbers depends on the number of
    its threads. The eight sums are independent, so that they are added in parallel by vector instructions.
    """
    count = len(x)
    whole = count - count % 8
    a = b = c = d = e = f = g = h = 0.0
    for i in range(0, whole, 8):
        a += x[i] * y[i]
        b += x[i + 1] * y[i + 1]
        c += x[i + 2] * y[i + 2]
        d += x[i + 3] * y[i + 3]
        e += x[i + 4] * y[i + 4]
        f += x[i + 5] * y[i + 5]
        g += x[i + 6] * y[i + 6]
        h += x[i + 7] * y[i + 7]
    for i in range(whole, count):
        a += x[i] * y[i]
    return ((a + b) + (c + d)) + ((e + f) + (g + h))


def face_centroids(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """(F, 3) the mean of the three corners of every face."""
    centroids = np.empty((len(faces), 3))
    in_blocks(_write_centroids, len(faces), vertices, faces, centroids)
    return centroids


@kernel
def _write_centroids(start, end, vertices, faces, centroids):  # type: ignore[no-untyped-def]
    for f in range(start, end):
        a, b, c = vertices[faces[f, 0]], vertices[faces[f, 1]], vertices[faces[f, 2]]
        for axis in range(3):
            centroids[f, axis] = (a[axis] + b[axis] + c[axis]) / 3.0


def area_moments(vertices: FloatArray, faces: IntArray, areas: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(3,) centroid and (3, 3) covariance of the area of faces (F, 3), by the exact integrals over the triangles."""
    count, arrays = len(faces), (vertices, faces, areas)
    area, *firsts = sums_of_blocks(_area_moments, count, *arrays, np.zeros(3))[:4].tolist()
    centre = np.array(firsts) / area
    xx, yy, zz, xy, xz, yz = sums_of_blocks(_area_moments, count, *arrays, centre)[4:] / area
    return centre, np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


@kernel
def _area_moments(start, end, vertices, faces, areas, centre):  # type: ignore[no-untyped-def]
    """(10,) area of some faces, and its moments x, y, z, xx, yy, zz, xy, xz, yz about a centre (3,)."""
    sums = np.zeros(10)
    corner = np.empty((4, 3))  # and their mean
    factor = (1.0 / 12.0, 1.0 / 12.0, 1.0 / 12.0, 9.0 / 12.0)
    for f in range(start, end):
        for axis in range(3):
            for k in range(3):
                corner[k, axis] = vertices[faces[f, k], axis] - centre[axis]
            corner[3, axis] = (corner[0, axis] + corner[1, axis] + corner[2, axis]) / 3.0
            sums[1 + axis] += areas[f] * corner[3, axis]
        sums[0] += areas[f]
        for k in range(4):
            x, y, z = corner[k, 0], corner[k, 1], corner[k, 2]
            weight = factor[k] * areas[f]
            sums[4] += weight * x * x
            sums[5] += weight * y * y
            sums[6] += weight * z * z
            sums[7] += weight * x * y
            sums[8] += weight * x * z
            sums[9] += weight * y * z
    return sums
