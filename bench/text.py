"""Formats numbers and tables as plain text."""

import math
from collections.abc import Sequence


def number(value: float, decimals: int = 4) -> str:
    """Return a number with fixed decimals, or a dash if it is undefined (nan)."""
    return "-" if math.isnan(value) else f"{value:.{decimals}f}"


def format_table(header: Sequence[str], rows: Sequence[Sequence[str]], rules: Sequence[int] = ()) -> str:
    """Return columns under their headings, the first one aligned left, the others right.

    Parameters
    ----------
    rows : may be shorter than the header; missing cells are empty.
    rules : rows with a horizontal line above them; there is always one below the header.
    """
    lines = [list(header), *([*row, *[""] * (len(header) - len(row))] for row in rows)]
    widths = [max(len(cell) for cell in column) for column in zip(*lines, strict=True)]
    rule = "-" * (sum(widths) + 2 * (len(widths) - 1))
    text = [_line(cells, widths) for cells in lines]
    for row in sorted({0, *rules}, reverse=True):
        text.insert(row + 1, rule)
    return "\n".join(text)


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    first, *others = zip(cells, widths, strict=True)
    return "  ".join([first[0].ljust(first[1]), *(cell.rjust(width) for cell, width in others)]).rstrip()
