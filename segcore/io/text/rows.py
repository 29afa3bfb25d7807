"""Rows of numbers as lines of text."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

_ROWS = 2**14  # lines in a piece; OBJ files of 500,000 faces take as long with 2**12 and 10 % longer with 2**16


def format_rows(form: str, rows: NDArray[Any], *more: NDArray[Any]) -> Iterator[bytes]:
    """Format each row as a line of text; the lines come in pieces.

    Parameters
    ----------
    form : the line with a ``%`` conversion for each number; ``%r`` gives floats that read back as the same number.
    rows, more : (N, *) the numbers; a line has those of ``rows``, then those of ``more``.
    """
    for first in range(0, len(rows), _ROWS):
        block = np.hstack([values[first : first + _ROWS] for values in (rows, *more)])
        yield (form * len(block) % tuple(block.ravel().tolist())).encode("ascii")
