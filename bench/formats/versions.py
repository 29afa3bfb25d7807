"""The times of two versions of Cleave in the same run, in turn."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from bench.checkout import HERE
from bench.errors import BenchmarkError
from bench.guarded import Guarded

_PROBE = Path(__file__).with_name("probe.py")


class Times(NamedTuple):
    """The least CPU seconds of some runs."""

    base: float
    here: float


def compare(base: Path, lines: Sequence[str], runs: int) -> Iterator[Times]:
    """Yield the times of each line of ``bench.formats.probe`` by both versions, which take turns.

    Raises
    ------
    BenchmarkError
        If one of them cannot do it.
    """
    with _probe(base) as first, _probe(HERE) as second:
        for line in lines:
            pairs = [(_seconds(first, line), _seconds(second, line)) for _ in range(runs)]
            yield Times(*map(min, zip(*pairs, strict=True)))


def _probe(root: Path) -> Guarded:
    return Guarded([sys.executable, str(_PROBE), "serve"], {**os.environ, "PYTHONPATH": str(root)})


def _seconds(probe: Guarded, line: str) -> float:
    answer = probe.ask(line)
    if "seconds" not in answer:
        raise BenchmarkError(f"A version of Cleave could not {line}: {answer['error']}.")
    return float(answer["seconds"])
