"""Eigenvalues and eigenvectors of symmetric tridiagonal matrices, without BLAS."""

import numpy as np

from segcore.arrays import FloatArray
from segcore.jit.decorators import inner_kernel

_EPS = float(np.finfo(np.float64).eps)
_MOST_SWEEPS = 60  # for one eigenvalue; two are the rule


@inner_kernel
def diagonalise(diagonal: FloatArray, beside: FloatArray, rows: FloatArray) -> None:
    """Find the eigenvalues of a tridiagonal matrix T by the implicit QL method. O(N^2 (N + R)) at most.

    All arrays are changed in place. No sum depends on a number of threads.

    Parameters
    ----------
    diagonal : (N,) of T; then the eigenvalues, in no order.
    beside : (N,) the first N - 1 are beside the diagonal of T; then zeros.
    rows : (R, N) multiplied from the right by the matrix of the eigenvectors: of the unit matrix the eigenvectors
        remain, as columns, and of one of its rows that component of all of them.

    References
    ----------
    Dubrulle, Martin and Wilkinson, The implicit QL algorithm, Numerische Mathematik 12, 1968.
    """
    count = len(diagonal)
    beside[count - 1] = 0.0
    for first in range(count):
        for _ in range(_MOST_SWEEPS):
            last = first
            while last < count - 1:
                if abs(beside[last]) <= _EPS * (abs(diagonal[last]) + abs(diagonal[last + 1])):
                    break
                last += 1
            if last == first:
                break
            _sweep(diagonal, beside, rows, first, last)


@inner_kernel
def _sweep(diagonal, beside, rows, first, last):  # type: ignore[no-untyped-def]
    """One implicit QL step with Wilkinson's shift on the block first..last, of which no entry beside vanishes."""
    slope = 0.5 * (diagonal[first + 1] - diagonal[first]) / beside[first]
    root = np.hypot(slope, 1.0)
    ahead = diagonal[last] - diagonal[first] + beside[first] / (slope + (root if slope >= 0.0 else -root))
    sine, cosine, shift = 1.0, 1.0, 0.0
    for i in range(last - 1, first - 1, -1):
        bulge, along = sine * beside[i], cosine * beside[i]
        length = np.hypot(bulge, ahead)
        beside[i + 1] = length
        if length == 0.0:  # the block falls apart
            diagonal[i + 1] -= shift
            beside[last] = 0.0
            return
        sine, cosine = bulge / length, ahead / length
        ahead = diagonal[i + 1] - shift
        turned = (diagonal[i] - ahead) * sine + 2.0 * cosine * along
        shift = sine * turned
        diagonal[i + 1] = ahead + shift
        ahead = cosine * turned - along
        for k in range(len(rows)):
            upper = rows[k, i + 1]
            rows[k, i + 1] = sine * rows[k, i] + cosine * upper
            rows[k, i] = cosine * rows[k, i] - sine * upper
    diagonal[first] -= shift
    beside[first] = ahead
    beside[last] = 0.0
