"""A benchmark folder of two shapes with known parts, and a method with a known result.

The method is in a module, not in a test, because other processes import it.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.peers.method import MethodFailed, Outcome
from segcore.mesh import Mesh
from segcore.shapes import Shape, burr, dumbbell

# By number: category, shape, number of segments. The bearing of Figure 5 must be one of them.
SHAPES: dict[int, tuple[str, Shape, int]] = {
    1: ("Human", burr(subdivisions=3), 7),
    341: ("Bearing", dumbbell(rings=24, around=16), 3),
}


def write_benchmark(folder: Path) -> Path:
    """Write the two models, each with two people: one labels every part, the other one joins the last two."""
    (folder / "off").mkdir(parents=True)
    for number, (_, shape, _) in SHAPES.items():
        mesh = shape.mesh
        lines = ["OFF", f"{len(mesh.vertices)} {len(mesh.faces)} 0"]
        lines += [" ".join(map(repr, vertex)) for vertex in mesh.vertices.tolist()]
        lines += [f"3 {a} {b} {c}" for a, b, c in mesh.faces.tolist()]
        (folder / "off" / f"{number}.off").write_text("\n".join(lines) + "\n")
        people = folder / "seg" / "Benchmark" / str(number)
        people.mkdir(parents=True)
        for person, labels in enumerate((shape.parts, np.minimum(shape.parts, shape.parts.max() - 1))):
            np.savetxt(people / f"{number}_{person}.seg", labels, fmt="%d")
    rows = [f"{number}\t{category}\t{segments}" for number, (category, _, segments) in SHAPES.items()]
    (folder / "segments.tsv").write_text("\n".join(["model\tcategory\tsegments", *rows]) + "\n")
    return folder


@dataclass(frozen=True)
class Slices:
    """Cuts a mesh across its x axis into parts of equally many faces; fails on meshes with too many."""

    key: str = "slices"
    most_faces: int = 10**6
    settings: str = "1"

    @property
    def title(self) -> str:
        return self.key.capitalize()

    def prepare(self) -> None:
        pass

    def warm_up(self) -> None:
        pass

    def __call__(self, mesh: Mesh, segments: int) -> Outcome:
        if len(mesh.faces) > self.most_faces:
            raise MethodFailed("too many faces.")
        return Outcome(self.labels(mesh, segments), cpu_s=0.5)

    def labels(self, mesh: Mesh, segments: int | None = None) -> np.ndarray:
        rank = np.argsort(np.argsort(mesh.corners.mean(axis=1)[:, 0], kind="stable"), kind="stable")
        return (rank * (segments or 1) // len(rank)).astype(np.int32)
