"""CGAL's segmentation by the shape diameter function, run as a separate program.

The program is C++ (``sdf_segmentation.cpp``), built at the first use with the compiler and the CGAL headers of the
system.
"""

from __future__ import annotations

import io
import shutil
import signal
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.errors import BenchmarkError
from bench.peers.method import MethodFailed, Outcome, source_digest

if TYPE_CHECKING:
    from segcore.arrays import IntArray
    from segcore.mesh import Mesh

_SOURCE = Path(__file__).with_name("sdf_segmentation.cpp")
_COMPILER = "g++"
_OPTIONS = ("-O3", "-DNDEBUG", "-std=c++17")
_LIBRARIES = ("-lmpfr", "-lgmp")
_FEWEST_CLUSTERS, _MOST_CLUSTERS = 2, 15  # set by hand, around the default; each cluster may be several segments
_DEFAULT_CLUSTERS = 5  # default of segmentation_from_sdf_values
_LONGEST_S = 900.0  # seconds for one mesh; the largest of the benchmark takes about 40


@dataclass(frozen=True, slots=True, eq=False)
class Clustering:
    """One of the segmentations of a mesh in the output of the program."""

    clusters: int  # number of clusters of shape diameters; each connected piece of a cluster is a segment
    cpu_s: float  # without the shape diameters
    labels: IntArray  # (F,)

    @property
    def segments(self) -> int:
        return len(np.unique(self.labels))


@dataclass(frozen=True, slots=True, eq=False)
class Clusterings:
    """The output of the program for one mesh."""

    sdf_s: float  # CPU seconds of the shape diameters
    each: tuple[Clustering, ...]  # one for every number of clusters, at least one

    def nearest(self, segments: int) -> Clustering:
        """Return the clustering whose number of segments is nearest; of several, the nearest to CGAL's 5 clusters."""
        return min(
            self.each,
            key=lambda one: (abs(one.segments - segments), abs(one.clusters - _DEFAULT_CLUSTERS), one.clusters),
        )


@dataclass(frozen=True, slots=True)
class CgalSdf:
    """CGAL's default settings, with the number of clusters that leads to the nearest number of segments.

    CGAL clusters faces by the thickness of the body under them and makes every connected piece of a cluster a segment:
    the number of segments cannot be chosen. It is run with 2 to 15 clusters, and the result whose number of segments is
    nearest to the given one is used. The time is that of one segmentation with this number of clusters.

    References
    ----------
    Shapira, Shamir, Cohen-Or, Consistent mesh partitioning and skeletonisation using the shape diameter function, The
    Visual Computer 24, 2008.
    """

    folder: Path  # the folder in which the program is built and kept

    key = "cgal"
    title = "CGAL SDF"

    @property
    def settings(self) -> str:
        return source_digest(__file__, _SOURCE)

    @property
    def program(self) -> Path:
        return self.folder / f"sdf_segmentation-{source_digest(_SOURCE)}"

    def prepare(self) -> None:
        """Build the program, unless the folder has it.

        Raises
        ------
        BenchmarkError
            If it cannot be built.
        """
        if self.program.exists():
            return
        if shutil.which(_COMPILER) is None:
            raise BenchmarkError(f"CGAL's segmentation needs {_COMPILER}: install it, or leave cgal out of --peers.")
        unfinished = self.program.with_suffix(".part")
        command = [_COMPILER, *_OPTIONS, "-o", str(unfinished), str(_SOURCE), *_LIBRARIES]
        built = subprocess.run(command, capture_output=True, text=True)
        if built.returncode != 0:
            reason = next((line for line in built.stderr.splitlines() if "error" in line), "no reason given")
            raise BenchmarkError(
                f"CGAL's segmentation cannot be built ({reason}): install CGAL's headers (libcgal-dev on Debian), "
                "or leave cgal out of --peers."
            )
        unfinished.rename(self.program)

    def warm_up(self) -> None:
        """Do nothing: the program is another process."""

    def __call__(self, mesh: Mesh, segments: int) -> Outcome:
        clusterings = read_clusterings(self._run(mesh), len(mesh.faces))
        chosen = clusterings.nearest(segments)
        return Outcome(chosen.labels, clusterings.sdf_s + chosen.cpu_s)

    def _run(self, mesh: Mesh) -> str:
        command = [str(self.program), str(_FEWEST_CLUSTERS), str(_MOST_CLUSTERS)]
        try:
            done = subprocess.run(command, input=_as_text(mesh), capture_output=True, text=True, timeout=_LONGEST_S)
        except subprocess.TimeoutExpired:
            raise MethodFailed(f"CGAL did not end within {_LONGEST_S:.0f} seconds.") from None
        except OSError as error:
            raise BenchmarkError(f"{self.program} cannot be run: {error.strerror}.") from error
        if done.returncode != 0:
            raise MethodFailed(f"CGAL: {done.stderr.strip() or _exit(done.returncode)}.")
        return done.stdout


def read_clusterings(output: str, face_count: int) -> Clusterings:
    """Read the output of the program.

    Raises
    ------
    MethodFailed
        If the output is malformed.
    """
    try:
        first, *lines = output.splitlines()
        clusterings = tuple(_clustering(line) for line in lines)
        if not clusterings or any(len(one.labels) != face_count for one in clusterings):
            raise ValueError("it does not have one label for every face")
        return Clusterings(float(first), clusterings)
    except ValueError as error:
        raise MethodFailed(f"CGAL's output cannot be read: {error}.") from error


def _clustering(line: str) -> Clustering:
    clusters, cpu_s, *labels = line.split()
    return Clustering(int(clusters), float(cpu_s), np.array(labels, dtype=np.int32))


def _as_text(mesh: Mesh) -> str:
    text = io.StringIO()
    text.write(f"{len(mesh.vertices)} {len(mesh.faces)}\n")
    np.savetxt(text, mesh.vertices, "%.17g")
    np.savetxt(text, mesh.faces, "%d")
    return text.getvalue()


def _exit(status: int) -> str:
    return f"ended by signal {signal.Signals(-status).name}" if status < 0 else f"ended with status {status}"
