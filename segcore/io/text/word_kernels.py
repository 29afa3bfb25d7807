"""Compiled kernels that find the words of a text. Arrays in, arrays out."""

from typing import Any, TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

from segcore.arrays import BoolArray

Bytes: TypeAlias = NDArray[np.uint8]
Offsets: TypeAlias = NDArray[np.signedinteger[Any]]

SPACE = np.uint8(32)  # this byte and all below it separate words
_TAB, _NEWLINE, _CARRIAGE_RETURN = np.uint8(9), np.uint8(10), np.uint8(13)
_BLOCK = 255


@njit(cache=True)
def has_controls(text: Bytes) -> bool:
    """Whether there are control characters in a text that are no white space."""
    found = np.uint8(0)
    for byte in text:
        found = np.uint8(found | np.uint8((byte < _TAB) | ((byte > _CARRIAGE_RETURN) & (byte < SPACE))))
    return found != 0


@njit(cache=True)
def count_words(text: Bytes) -> tuple[int, int]:
    """The number of words, and of newlines.

    Blocks are so short that their counts fit in a byte: then the processor counts many bytes at a time.
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


@njit(cache=True)
def find_word_starts(text: Bytes, begin: int, start: Offsets, line_start: Offsets) -> int:
    """Fill the offset of every word, and in (L + 1,) or more the first word of every line that has one, then W.

    Returns
    -------
    L, the number of lines that have a word.
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


@njit(cache=True)
def find_equal(text: Bytes, start: Offsets, indices: Offsets, word: Bytes, found: BoolArray) -> None:
    """Mark in ``found`` (N,) which of the words at ``indices`` are ``word``."""
    for i in range(len(found)):
        at = start[indices[i]]
        end = at + len(word)
        found[i] = end <= len(text) and (end == len(text) or text[end] <= SPACE)
        for k in range(len(word)):
            found[i] = found[i] and text[at + k] == word[k]
