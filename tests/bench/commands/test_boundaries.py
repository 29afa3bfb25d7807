"""The lengths of cuts, on strips on which they can be counted."""

from pathlib import Path

import numpy as np
import pytest

from bench.commands.boundaries import CutLengths, length_of_cuts, measure, render
from bench.princeton.dataset import Model
from bench.princeton.surface import Surface
from helpers.bench.strips import EvenSegmenter, cut_at, strip
from segcore.mesh import Mesh

COLUMNS = 12


def test_the_length_of_cuts_is_in_units_of_the_root_of_the_area():
    vertices, faces = strip(COLUMNS)
    for scale in (1.0, 7.0):
        mesh = Mesh(scale * vertices, faces)
        surface = Surface.from_mesh(mesh.vertices, mesh.faces)
        assert length_of_cuts(mesh, surface, cut_at(COLUMNS, 4, 8)) == pytest.approx(2 / np.sqrt(COLUMNS))
        assert length_of_cuts(mesh, surface, np.zeros(len(faces), np.int64)) == 0


def test_a_model_is_compared_with_all_of_its_people(tmp_path: Path):
    vertices, faces = strip(COLUMNS)
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0", *(f"{x} {y} {z}" for x, y, z in vertices)]
    (tmp_path / "1.off").write_text("\n".join(lines + [f"3 {a} {b} {c}" for a, b, c in faces]) + "\n")
    for person, labels in enumerate((cut_at(COLUMNS, 4, 8), cut_at(COLUMNS, 6))):
        np.savetxt(tmp_path / f"1_{person}.seg", labels, fmt="%d")
    lengths = measure(Model(1, "Rod", 3, tmp_path / "1.off", tmp_path), EvenSegmenter(), seed=0)
    assert lengths.cleave == pytest.approx(2 / np.sqrt(COLUMNS))
    assert lengths.people == pytest.approx(1.5 / np.sqrt(COLUMNS))


def test_the_ratio_is_a_geometric_mean_by_category():
    text = render([CutLengths("Rod", 2.0, 1.0, 0.1, 0.2), CutLengths("Rod", 1.0, 2.0, 0.3, 0.2)])
    for row in text.splitlines()[2:]:
        if row and not row.startswith("-"):
            assert row.split()[-6:] == ["2", "1.5000", "1.5000", "1.0000", "0.2000", "0.2000"]
