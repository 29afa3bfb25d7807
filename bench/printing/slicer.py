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
_LAYER = "0.3"  # mm
_TOOL = re.compile(r"^T(\d+)", re.MULTILINE)
_VOLUME = re.compile(r"^volume = (\S+)$", re.MULTILINE)
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


def volumes(path: Path) -> list[float]:
    """Return the volume of every object of a file as PrusaSlicer measures it, in mm^3.

    Raises
    ------
    BenchmarkError
        If the program is missing or fails.
    """
    return [float(found) for found in _VOLUME.findall(_run("--info", str(path)))]


def tools_of(path: Path, folder: Path, extruders: int) -> set[int]:
    """Return the tools that the G-code of a file changes to, for a printer with several extruders and on a raft.

    With one extruder there are no changes.

    Raises
    ------
    BenchmarkError
        If the program is missing or fails.
    """
    target, nozzles = folder / "print.gcode", ",".join(["0.4"] * extruders)
    _run(
        *(
            "--export-gcode",
            "--nozzle-diameter",
            nozzles,
            "--layer-height",
            _LAYER,
            "--raft-layers",
            "2",
            "--center",
            "100,100",
        ),
        *("--output", str(target), str(path)),
    )
    return set(map(int, _TOOL.findall(target.read_text())))


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
