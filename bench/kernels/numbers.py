"""Decimal numbers of a text file: the parser of Cleave beside NumPy and Python."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from bench.kernels.timing import cpu_s
from segcore.io.text.words import find_words

if TYPE_CHECKING:
    from segcore.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class NumberTimes:
    """The cost of a method for one text."""

    parse_s: float
    wrong: int  # results that are not the nearest floats to the decimal numbers


def vertex_lines(count: int, decimals: int) -> bytes:
    """Random coordinates as lines of three numbers, as in an OFF file."""
    rows = np.random.default_rng(0).uniform(-1, 1, (count, 3))
    form = f"%.{decimals}f %.{decimals}f %.{decimals}f\n"
    return (form * count % tuple(rows.ravel().tolist())).encode("ascii")


def cleave(text: bytes) -> FloatArray:
    words = find_words(text)
    return words.floats(0, words.count)


def fromstring(text: bytes) -> FloatArray:
    return np.fromstring(text.decode("ascii"), sep=" ")


def split(text: bytes) -> FloatArray:
    return np.array(text.split(), dtype=np.float64)


def loadtxt(text: bytes) -> FloatArray:
    return np.loadtxt(io.BytesIO(text)).ravel()


Parse: TypeAlias = Callable[[bytes], "FloatArray"]
METHODS: dict[str, Parse] = {
    "Cleave": cleave,
    "np.fromstring": fromstring,
    "np.array of split": split,
    "np.loadtxt": loadtxt,
}


def measure(text: bytes, runs: int) -> dict[str, NumberTimes]:
    """Return the time of every method, and how many numbers differ from those of Python's ``float``."""
    expected = np.array([float(word) for word in text.split()])
    return {
        name: NumberTimes(cpu_s(partial(parse, text), runs), int((parse(text) != expected).sum()))
        for name, parse in METHODS.items()
    }
