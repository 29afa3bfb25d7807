"""What PrusaSlicer, a program of the system, finds in files for printing."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from bench.errors import BenchmarkError

PROGRAM = "prusa-slicer"
_TIMEOUT_S = 300
_MANIFOLD = re.compile(r"^manifold = (yes|no)$", re.MULTILINE)


def are_manifold(paths: Sequence[Path]) -> list[bool]:
    """Return for every object in some files whether PrusaSlicer takes it for manifold, without a repair.

    Raises
    ------
    BenchmarkError
        If the program is missing or fails.
    """
    return [found == "yes" for found in _MANIFOLD.findall(_run("--info", *map(str, paths)))]


def slice_file(path: Path, target: Path, scale: float) -> None:
    """Slice the objects of a file, scaled by a factor to be of a size that can be printed, on a raft, into G-code.

    Raises
    ------
    BenchmarkError
        If the program is missing or fails.
    """
    _run(
        "--export-gcode",
        "--raft-layers",
        "2",
        "--scale",
        str(scale),
        "--center",
        "100,100",
        "--output",
        str(target),
        str(path),
    )


def sliced_with(path: Path, target: Path, extruders: int) -> None:
    """Slice the objects of a file for a printer with several extruders into G-code, at the size of the file.

    Raises
    ------
    BenchmarkError
        If the program is missing or fails.
    """
    nozzles = ",".join(["0.4"] * extruders)
    _run("--export-gcode", "--nozzle-diameter", nozzles, "--center", "100,100", "--output", str(target), str(path))


def _run(*arguments: str) -> str:
    program = shutil.which(PROGRAM)
    if program is None:
        raise BenchmarkError(f"The program {PROGRAM} is missing: install the Debian package {PROGRAM}.")
    done = subprocess.run(
        [program, *arguments], capture_output=True, text=True, errors="replace", timeout=_TIMEOUT_S, check=False
    )
    if done.returncode:
        raise BenchmarkError(f"{PROGRAM} {arguments[0]} failed: {done.stderr.strip()[-300:]}")
    return done.stdout
