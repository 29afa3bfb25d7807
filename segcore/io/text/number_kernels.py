"""Compiled kernels that parse the words of a text as numbers, correctly rounded."""

import numpy as np

from segcore.arrays import BoolArray, FloatArray, LongArray
from segcore.io.text.word_kernels import SPACE, Bytes, Offsets
from segcore.jit.decorators import inner_kernel, kernel

_PLUS, _MINUS, _POINT, _ZERO, _NINE = 43, 45, 46, 48, 57
_UPPER_E, _LOWER_E = 69, 101
_DIGITS = 18  # any number of 18 digits fits into int64
_EXACT_POWER = 22  # 10**22 is the largest power of ten that is exact in float64
_LARGEST_POWER = 270  # beyond that, products and their errors could leave the normal range of float64
_LARGEST_EXPONENT = 1000  # in the text; float64 ends at 10**308
_SPLIT = 134217729.0  # 2**27 + 1, splits a float64 into two halves (Dekker 1971)
_DOUBT = 2.0**-98  # bound of the relative error of a product of two double-doubles


def _power_of_ten(power: int) -> tuple[float, float]:
    """The float nearest to 10**power, and the float nearest to the rest: divisions of int are correctly rounded."""
    numerator, denominator = 10 ** max(power, 0), 10 ** max(-power, 0)
    nearest = numerator / denominator
    a, b = nearest.as_integer_ratio()
    return nearest, (numerator * b - a * denominator) / (denominator * b)


_POWER, _POWER_REST = np.array([_power_of_ten(k) for k in range(-_LARGEST_POWER, _LARGEST_POWER + 1)]).T.copy()


@kernel
def parse_integers(text: Bytes, start: Offsets, values: LongArray) -> bool:
    """Fill ``values`` (N,) with the whole numbers at ``start`` (N,); return False if a word is not one."""
    for i in range(len(start)):
        end, value = whole_number(text, start[i])
        if end < 0 or (end < len(text) and text[end] > SPACE):
            return False
        values[i] = value
    return True


@kernel
def parse_floats(text: Bytes, start: Offsets, values: FloatArray, unread: BoolArray) -> int:
    """Fill ``values`` (N,) with the floats nearest to the decimal numbers at ``start`` (N,).

    Returns
    -------
    The number of words that are marked in ``unread`` (N,): they are not plain decimal numbers, or have more than 18
    digits, or are too close to the midpoint of two floats.
    """
    count = 0
    for i in range(len(start)):
        is_read, value = decimal_number(text, start[i])
        values[i] = value
        unread[i] = not is_read
        count += not is_read
    return count


@inner_kernel
def whole_number(text: Bytes, at: int) -> tuple[int, int]:
    """The end of a whole number of at most 18 digits at ``at``, and the number; the end is -1 if there is none."""
    negative = text[at] == _MINUS
    if negative or text[at] == _PLUS:
        at += 1
    first, value = at, 0
    while at < len(text) and _ZERO <= text[at] <= _NINE:
        if at - first == _DIGITS:
            return -1, 0
        value = 10 * value + (text[at] - _ZERO)
        at += 1
    if at == first:
        return -1, 0
    return at, -value if negative else value


@inner_kernel
def decimal_number(text: Bytes, at: int) -> tuple[bool, float]:
    """Whether the word at ``at`` could be parsed as a decimal number, and the float nearest to it."""
    negative = text[at] == _MINUS
    if negative or text[at] == _PLUS:
        at += 1
    mantissa, digits, significant, power = 0, 0, 0, 0
    after_point = False
    while at < len(text):
        if text[at] == _POINT and not after_point:
            after_point = True
        elif _ZERO <= text[at] <= _NINE:
            digits += 1
            mantissa = 10 * mantissa + (text[at] - _ZERO)
            significant += significant > 0 or mantissa > 0
            power -= after_point
            if significant > _DIGITS:
                return False, 0.0
        else:
            break
        at += 1
    if digits == 0:
        return False, 0.0
    if at < len(text) and (text[at] == _LOWER_E or text[at] == _UPPER_E):
        at, exponent = whole_number(text, at + 1) if at + 1 < len(text) else (-1, 0)
        if at < 0 or abs(exponent) > _LARGEST_EXPONENT:
            return False, 0.0
        power += exponent
    if at < len(text) and text[at] > SPACE:
        return False, 0.0
    is_read, value = _scaled(mantissa, power)
    return is_read, -value if negative else value


@inner_kernel
def _scaled(mantissa: int, power: int) -> tuple[bool, float]:
    """Whether the float nearest to mantissa * 10**power is certain, and that float.

    One rounded operation if mantissa and power are small, else the product of two double-doubles.

    References
    ----------
    Clinger, How to read floating point numbers accurately, 1990.
    Dekker, A floating-point technique for extending the available precision, 1971.
    """
    if mantissa == 0:
        return True, 0.0
    high = float(mantissa)
    if mantissa < 2**53 and -_EXACT_POWER <= power <= _EXACT_POWER:
        factor = _POWER[_LARGEST_POWER + abs(power)]
        return True, high * factor if power >= 0 else high / factor
    if abs(power) > _LARGEST_POWER:
        return False, 0.0
    low = float(mantissa - np.int64(high))
    factor, rest = _POWER[_LARGEST_POWER + power], _POWER_REST[_LARGEST_POWER + power]
    product = high * factor
    tail = _product_error(high, factor, product) + (high * rest + low * factor)
    value = product + tail
    tail -= value - product
    doubt = value * _DOUBT
    return value + (tail + doubt) == value and value + (tail - doubt) == value, value


@inner_kernel
def _product_error(a: float, b: float, product: float) -> float:
    """a * b - product, exact (Dekker 1971)."""
    a_high = a * _SPLIT - (a * _SPLIT - a)
    b_high = b * _SPLIT - (b * _SPLIT - b)
    a_low, b_low = a - a_high, b - b_high
    return ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low
