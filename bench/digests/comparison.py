"""Saves digests as JSON and compares two files of them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from bench.documents import save_json
from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from bench.digests.record import Digests


@dataclass(frozen=True, slots=True)
class Comparison:
    """Two files of digests, A and B."""

    equal: int  # number of keys with equal digests
    different: dict[str, list[str]]  # levels, formats or "segments" that differ, by key
    only_a: list[str]  # keys
    only_b: list[str]


def save_digests(path: Path, digests: Mapping[str, Digests]) -> None:
    """Write digests as JSON.

    Raises
    ------
    BenchmarkError
        If the file cannot be written.
    """
    save_json(path, dict(sorted(digests.items())), "digests")


def load_digests(path: Path) -> dict[str, Digests]:
    """Read a file that ``save_digests`` wrote.

    Raises
    ------
    BenchmarkError
        If the file cannot be read or has another format.
    """
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BenchmarkError(f"{path} cannot be read: {error.strerror}.") from error
    except ValueError as error:
        raise BenchmarkError(f"{path} is not JSON: give a file that digests --output wrote.") from error
    if not isinstance(document, dict) or not all(isinstance(entry, dict) for entry in document.values()):
        raise BenchmarkError(f"{path} does not contain digests: give a file that digests --output wrote.")
    return document


def compare(a: Mapping[str, Digests], b: Mapping[str, Digests]) -> Comparison:
    """Compare the digests under the keys that both files contain."""
    common = sorted(a.keys() & b.keys())
    different = {key: _differences(a[key], b[key]) for key in common if a[key] != b[key]}
    return Comparison(
        equal=len(common) - len(different),
        different=different,
        only_a=sorted(a.keys() - b.keys()),
        only_b=sorted(b.keys() - a.keys()),
    )


def render(comparison: Comparison) -> str:
    """Return a line for every difference, and the numbers of equal and different keys."""
    lines = [f"{key}: {', '.join(names)}" for key, names in comparison.different.items()]
    lines.append(
        f"{comparison.equal} equal, {len(comparison.different)} different, {len(comparison.only_a)} only in A, "
        f"{len(comparison.only_b)} only in B."
    )
    return "\n".join(lines)


def _differences(a: Digests, b: Digests) -> list[str]:
    return sorted(name for name in a.keys() | b.keys() if a.get(name) != b.get(name))
