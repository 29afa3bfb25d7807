"""A compiled logarithm for long rows of numbers."""

import numpy as np

from segcore.jit.decorators import kernel

_SQRT_HALF = np.uint64(0x3FE6A09E667F3BCD)  # the bits of sqrt(1/2)
_EXPONENT = np.uint64(52)  # bits of a float64 below its exponent
_AS_FLOAT = np.uint64(0x4330000000000000)  # the bits of 2**52: or-ed with an integer below, those of their sum
_TWO_52 = 2.0**52
_LN_2 = 0.6931471805599453


@kernel
def squeeze(row, work):  # type: ignore[no-untyped-def]
    """Replace numbers (N,) by sign(x) log(1 + |x|), within 1e-15.

    With 1 + |x| = 2**k m and m in sqrt(1/2)..sqrt(2), log m is 2 artanh s with s = (m - 1) / (m + 1), a series in s**2.
    There are no calls, so that the loops become vector instructions, unlike those of numpy.log1p in compiled code.

    Parameters
    ----------
    work : (2, N) work array.
    """
    m, k = work[0, : len(row)], work[1, : len(row)]
    m_bits, k_bits = m.view(np.uint64), k.view(np.uint64)
    for i in range(len(row)):
        m[i] = 1.0 + abs(row[i])
    for i in range(len(row)):
        exponent = (m_bits[i] - _SQRT_HALF) >> _EXPONENT
        k_bits[i] = exponent | _AS_FLOAT
        m_bits[i] = m_bits[i] - (exponent << _EXPONENT)
    for i in range(len(row)):
        s = (m[i] - 1.0) / (m[i] + 1.0)
        p = s * s
        series = 1.0 / 19.0
        series = series * p + 1.0 / 17.0
        series = series * p + 1.0 / 15.0
        series = series * p + 1.0 / 13.0
        series = series * p + 1.0 / 11.0
        series = series * p + 1.0 / 9.0
        series = series * p + 1.0 / 7.0
        series = series * p + 1.0 / 5.0
        series = series * p + 1.0 / 3.0
        logarithm = (k[i] - _TWO_52) * _LN_2 + (2.0 * s + 2.0 * s * p * series)
        row[i] = logarithm if row[i] >= 0.0 else -logarithm
