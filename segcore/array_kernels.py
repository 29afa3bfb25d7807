"""Kernels on arrays that several stages share. :mod:`segcore.arrays` has none, so that it is imported without numba."""

from numba import njit

from segcore.arrays import FloatArray


@njit(cache=True)
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
