"""Rows of numbers as lines of text, written in bulk."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

_ROWS = 2**14  # lines that are put together at a time


def format_rows(form: str, rows: NDArray[Any], *more: NDArray[Any]) -> Iterator[bytes]:
    """A line for every row, in pieces.

    Parameters
    ----------
    form : the line with a ``%`` conversion for each number; ``%r`` gives floats that read back as the same number.
    rows, more : (N, *) the numbers, those of ``more`` following those of ``rows``.
    """
    for first in range(0, len(rows), _ROWS):
        block = np.hstack([values[first : first + _ROWS] for values in (rows, *more)])
        yield (form * len(block) % tuple(block.ravel().tolist())).encode("ascii")
