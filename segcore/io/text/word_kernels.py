"""Compiled kernels that find the words and lines of a text."""

from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import BoolArray
from segcore.jit.decorators import kernel

Bytes: TypeAlias = NDArray[np.uint8]
Offsets: TypeAlias = NDArray[np.signedinteger[Any]]

SPACE = np.uint8(32)  # this byte and all below it separate words
_TAB, _NEWLINE, _CARRIAGE_RETURN = np.uint8(9), np.uint8(10), np.uint8(13)
_BLOCK = 255  # bytes, so that the counts of a block fit into a byte


class Lines(NamedTuple):
    """The words of a text by line; lines without words do not count."""

    text: Bytes
    start: Offsets  # (W,) offset of each word
    line_start: Offsets  # (L + 1,) the first word of each line, then W


@kernel
def has_controls(text: Bytes) -> bool:
    """Whether a text contains control characters other than white space."""
    found = np.uint8(0)
    for byte in text:
        found = np.uint8(found | np.uint8((byte < _TAB) | ((byte > _CARRIAGE_RETURN) & (byte < SPACE))))
    return found != 0


@kernel
def count_words(text: Bytes) -> tuple[int, int]:
    """The number of words and the number of newlines.

    The counts of a block fit into a byte, so that the compiler vectorizes the inner loop.
    """
    words, newlines = int(len(text) > 0 and text[0] > SPACE), int(len(text) > 0 and text[0] == _NEWLINE)
    for first in range(1, len(text), _BLOCK):
        block, before = text[first : first + _BLOCK], text[first - 1 : first - 1 + _BLOCK]
        starts, ends = np.uint8(0), np.uint8(0)
        for i in range(len(block)):
            starts = np.uint8(starts + np.uint8((block[i] > SPACE) & (before[i] <= SPACE)))
            ends = np.uint8(ends + np.uint8(block[i] == _NEWLINE))
        words += int(starts)
        newlines += int(ends)
    return words, newlines


@kernel
def find_word_starts(text: Bytes, begin: int, start: Offsets, line_start: Offsets) -> int:
    """Find the words of a text from byte ``begin`` on.

    Parameters
    ----------
    start : (W,) filled with the offset of each word.
    line_start : (L + 1,) or longer, filled with the first word of each line that has words, then W.

    Returns
    -------
    L, the number of lines that have words.
    """
    at, words, lines = begin, 0, 0
    is_new_line = True
    while at < len(text):
        if text[at] <= SPACE:
            is_new_line |= text[at] == _NEWLINE
            at += 1
            continue
        if is_new_line:
            line_start[lines] = words
            lines += 1
            is_new_line = False
        start[words] = at
        words += 1
        while at < len(text) and text[at] > SPACE:
            at += 1
    line_start[lines] = words
    return lines


@kernel
def find_equal(text: Bytes, start: Offsets, indices: Offsets, word: Bytes, found: BoolArray) -> None:
    """Set ``found`` (N,) to whether the words ``indices`` (N,) are equal to ``word``."""
    for i in range(len(found)):
        at = start[indices[i]]
        end = at + len(word)
        found[i] = end <= len(text) and (end == len(text) or text[end] <= SPACE)
        for k in range(len(word)):
            found[i] = found[i] and text[at + k] == word[k]
