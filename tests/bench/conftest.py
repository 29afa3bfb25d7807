"""Fixtures of the tests of the benchmarks."""

from pathlib import Path

import numpy as np
import pytest

from helpers.strips import write_strips
from segcore import shapes


@pytest.fixture
def strips(tmp_path: Path) -> Path:
    """A benchmark of three equal strips, see ``helpers.strips``."""
    return write_strips(tmp_path / "data")


@pytest.fixture
def shapes_folder(tmp_path: Path) -> Path:
    """A benchmark of four burrs and dumbbells; one person cuts each of them between the parts it was made of."""
    made = {1: ("Burr", shapes.burr(3, arms=4)), 3: ("Burr", shapes.burr(3, arms=6))}
    made |= {21: ("Bell", shapes.dumbbell(30, 16)), 23: ("Bell", shapes.dumbbell(24, 20))}
    data = tmp_path / "data"
    (data / "off").mkdir(parents=True)
    rows = []
    for number, (category, shape) in made.items():
        lines = ["OFF", f"{len(shape.mesh.vertices)} {len(shape.mesh.faces)} 0"]
        lines += [" ".join(map(repr, vertex)) for vertex in shape.mesh.vertices.tolist()]
        lines += [f"3 {a} {b} {c}" for a, b, c in shape.mesh.faces.tolist()]
        (data / "off" / f"{number}.off").write_text("\n".join(lines) + "\n")
        people = data / "seg" / "Benchmark" / str(number)
        people.mkdir(parents=True)
        np.savetxt(people / f"{number}_0.seg", shape.parts, fmt="%d")
        rows.append(f"{number}\t{category}\t{len(set(shape.parts.tolist()))}")
    (data / "segments.tsv").write_text("\n".join(["model\tcategory\tsegments", *rows]) + "\n")
    return data
