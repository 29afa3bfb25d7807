"""Numbers drawn into pictures."""

import numpy as np

from segcore.io.picture import ByteArray

# Rows of five pixels of the digits 0 to 9, as bits from left to right.
_ROWS = (
    (14, 17, 19, 21, 25, 17, 14),
    (4, 12, 4, 4, 4, 4, 14),
    (14, 17, 1, 2, 4, 8, 31),
    (31, 2, 4, 2, 1, 17, 14),
    (2, 6, 10, 18, 31, 2, 2),
    (31, 16, 30, 1, 1, 17, 14),
    (6, 8, 16, 30, 17, 17, 14),
    (31, 1, 2, 4, 8, 8, 8),
    (14, 17, 17, 14, 17, 17, 14),
    (14, 17, 17, 15, 1, 2, 12),
)
_DIGITS = (np.array(_ROWS)[:, :, None] >> np.arange(4, -1, -1)) & 1 == 1  # (10, 7, 5)
_INK, _PAPER = (0, 0, 0, 255), (255, 255, 255, 255)


def number_stamp(number: int, scale: int) -> ByteArray:
    """(7 scale + 2 scale, W, 4) pixels of a number in black on white, with a border of ``scale`` pixels."""
    columns = [_DIGITS[int(digit)] for digit in str(number)]
    gap = np.zeros((len(_ROWS[0]), 1), dtype=bool)
    ink = np.concatenate([column for digit in columns for column in (digit, gap)][:-1], axis=1)
    ink = np.pad(ink, 1).repeat(scale, axis=0).repeat(scale, axis=1)
    stamp: ByteArray = np.where(ink[..., None], _INK, _PAPER).astype(np.uint8)
    return stamp
