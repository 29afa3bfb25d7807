"""Compares the corners of glTF files with those of three.js."""

from __future__ import annotations

from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np

from bench.files.comparison import Comparison, Found
from bench.guarded import Guarded

SCRIPT = Path(__file__).with_name("positions.mjs")
TOLERANCE = 4e-6  # of the largest coordinate, set by hand: three.js computes the vertices of skins in float32


class Three:
    """Reads glTF files with the GLTFLoader of three.js."""

    def __init__(self, modules: Path, folder: Path) -> None:
        """Take the folder ``node_modules`` of three, and one for files that are overwritten."""
        self._program = Guarded(["node", str(SCRIPT), str(modules)])
        self._target = folder / "corners.f64"

    def __enter__(self) -> Three:
        return self

    def __exit__(self, *error: Any) -> None:
        self._program.__exit__(*error)

    def compare(self, path: Path) -> Comparison:
        """Compare the positions of all triangles, in the order of the file."""
        found = self._program.ask(f"{path}\t{self._target}")
        theirs = np.fromfile(self._target).reshape(-1, 3, 3) if "error" not in found else None
        return compare_corners(path, theirs, found)


def compare_corners(path: Path, theirs: np.ndarray | None, found: Found) -> Comparison:
    """Compare the mesh of a file with triangles (F, 3, 3), of which the corners may begin anywhere in any direction."""
    from segcore.errors import CleaveError
    from segcore.io import read_mesh

    refused = theirs is None or len(theirs) == 0
    try:
        ours = read_mesh(path, neighbours=True).corners
    except CleaveError as error:
        return Comparison(path, "both refuse" if refused else "only other", str(error))
    if refused or theirs is None:
        return Comparison(path, "only Cleave", str(found.get("error", "no faces")))
    if len(ours) != len(theirs):
        return Comparison(path, "other", f"{len(ours)} and {len(theirs)} faces")
    off = farthest(ours, theirs) / max(float(np.abs(theirs).max()), float(np.finfo(np.float32).tiny))
    return Comparison(path, "equal" if off <= TOLERANCE else "other", f"corners are off by {off:.1e} of the largest")


def farthest(a: np.ndarray, b: np.ndarray) -> float:
    """Return the largest difference of a coordinate of triangles (F, 3, 3), after the best order of each's corners."""
    orders = [np.abs(a[:, order] - b).max(axis=(1, 2)) for order in map(list, permutations(range(3)))]
    return float(np.min(orders, axis=0).max())
