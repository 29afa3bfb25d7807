"""The times of two versions of Cleave in the same run, in turn."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from bench.errors import BenchmarkError
from bench.guarded import Guarded

_PROBE = Path(__file__).with_name("probe.py")


class Times(NamedTuple):
    """The least CPU seconds of some runs."""

    base: float
    here: float


@contextmanager
def checked_out(commit: str) -> Iterator[Path]:
    """Check a commit out to a folder, which is removed at the end.

    Raises
    ------
    BenchmarkError
        If git cannot do so.
    """
    root = Path(__file__).parents[2]
    with tempfile.TemporaryDirectory(prefix="base-") as name:
        folder = Path(name) / "base"
        added = _git(root, "worktree", "add", "--detach", str(folder), commit)
        if added.returncode:
            raise BenchmarkError(f"git has no version {commit!r}: {added.stderr.strip()}")
        try:
            yield folder
        finally:
            _git(root, "worktree", "remove", "--force", str(folder))


def compare(base: Path, lines: Sequence[str], runs: int) -> Iterator[Times]:
    """Yield the times of each line of ``bench.formats.probe`` by both versions, which take turns.

    Raises
    ------
    BenchmarkError
        If one of them cannot do it.
    """
    here = Path(__file__).parents[2]
    with _probe(base) as first, _probe(here) as second:
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


def _git(root: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["git", "-C", str(root), *arguments], capture_output=True, text=True, check=False)
