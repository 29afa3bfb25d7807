"""Fixtures of the tests of the benchmarks."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from helpers.bench.one_process import InThisProcess
from helpers.bench.strips import write_strips
from segcore import shapes


@pytest.fixture
def one_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Models are evaluated in this process: another one takes seconds to load the kernels."""
    monkeypatch.setattr("bench.pool.ProcessPoolExecutor", InThisProcess)


@pytest.fixture
def strips(tmp_path: Path) -> Path:
    """A benchmark of three equal strips, see ``helpers.bench.strips``."""
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


@pytest.fixture
def assets(tmp_path: Path) -> Path:
    """Authored assets of two sets: a box in one part, and a dumbbell one face of which belongs to no part."""
    folder = tmp_path / "assets"
    dumbbell = shapes.dumbbell(24, 16)
    made = {("props", "crate"): (shapes.box(), np.zeros(12, dtype=np.int64))}
    made[("robots", "bell")] = (dumbbell.mesh, np.where(np.arange(len(dumbbell.parts)) == 0, -1, dumbbell.parts))
    rows = ["set\tname\tfaces\tparts\tcomponents_1rand\tkmeans_1rand"]
    for (collection, name), (mesh, parts) in made.items():
        (folder / collection).mkdir(parents=True)
        trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).export(folder / collection / f"{name}.ply")
        np.savetxt(folder / collection / f"{name}.seg", parts, fmt="%d")
        rows.append(f"{collection}\t{name}\t{len(mesh.faces)}\t{parts.max() + 1}\t0.5\t0.25")
    (folder / "models.tsv").write_text("\n".join(rows) + "\n")
    return folder
