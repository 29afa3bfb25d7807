"""Compares what two readers found in a file, and names the reason of a difference."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

AREA_TOLERANCE = 1e-6  # relative, set by hand: text and float32 have six or seven digits
VERDICTS = ("equal", "concave polygons", "other", "only Cleave", "only other", "both refuse")
"""How a file compares; ``concave polygons`` have other areas as fans, which is the area of the other reader."""

Found = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Comparison:
    """A file, and how two readers compare on it."""

    path: Path
    verdict: str  # of VERDICTS
    reason: str


def compare(path: Path, ours: Found, theirs: Found) -> Comparison:
    """Compare two answers of ``bench.files.reading``; a reader that finds no faces refuses the file."""
    verdict = _verdict(ours, theirs)
    return Comparison(path, verdict, _reason(verdict, ours, theirs))


def _verdict(ours: Found, theirs: Found) -> str:
    we_refuse, they_refuse = (not found.get("faces") for found in (ours, theirs))
    if we_refuse:
        return "both refuse" if they_refuse else "only other"
    if they_refuse:
        return "only Cleave"
    if ours["faces"] != theirs["faces"]:
        return "other"
    if _equal(ours["area"], theirs["area"]):
        return "equal"
    return "concave polygons" if _equal(ours.get("area of fans", math.nan), theirs["area"]) else "other"


def _equal(a: float, b: float) -> bool:
    return math.isclose(a, b, rel_tol=AREA_TOLERANCE)


def _reason(verdict: str, ours: Found, theirs: Found) -> str:
    if verdict in ("equal", "concave polygons"):
        return ""
    if verdict == "only Cleave":
        return f"{theirs.get('error', 'no faces')}: {theirs.get('message', '')}"
    if verdict in ("only other", "both refuse"):
        return f"{ours.get('message', ours.get('error', ''))}"
    notes = " ".join(ours["notes"])
    return f"{ours['faces']} and {theirs['faces']} faces, area {ours['area']:.6g} and {theirs['area']:.6g}. {notes}"
