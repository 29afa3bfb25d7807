"""Learning from a folder of small made-up models."""

import json
from pathlib import Path

import numpy as np
import pytest

from bench.__main__ import main
from bench.learning.boundaries import boundary_rows, cut_share
from bench.learning.fitting import fit
from bench.learning.folds import read_folds
from bench.princeton.dataset import read_models
from segcore import shapes
from segcore.clean.surface import build_surface
from segcore.learned.logistic import basis
from segcore.learned.models import LearnedModels


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Four burrs and dumbbells, each as one person cuts it who cuts where it was put together."""
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


def test_training_twice_gives_the_same_bytes_and_folds_to_judge_by(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    outputs = [tmp_path / "one.json", tmp_path / "two.json"]
    folds = tmp_path / "folds"
    for output in outputs:
        command = ["train", "--data", str(folder), "--output", str(output), "--folds", str(folds)]
        assert main(command) == 0
    assert outputs[0].read_bytes() == outputs[1].read_bytes()
    LearnedModels.from_document(json.loads(outputs[0].read_text()))
    assert sorted(path.name for path in folds.iterdir()) == ["bell.json", "burr.json"]
    assert set(read_folds(folds)) == {1, 3, 21, 23}
    capsys.readouterr()
    assert main(["princeton", "--data", str(folder), "--learned", str(folds)]) == 0
    assert "Burr" in capsys.readouterr().out


def test_a_folder_without_folds_is_one_sentence(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["princeton", "--data", str(folder), "--learned", str(tmp_path / "none")]) == 2
    assert "bench train --folds" in capsys.readouterr().err


def test_edges_along_the_cut_of_a_person_count_and_those_across_do_not(folder: Path) -> None:
    model = read_models(folder)[2]
    mesh = model.read_mesh()
    surface = build_surface(mesh)
    labels = model.read_people(len(mesh.faces))[0]
    share = cut_share(surface, [labels])
    cut = labels[surface.edge_faces[:, 0]] != labels[surface.edge_faces[:, 1]]
    np.testing.assert_allclose(share[cut], 1.0)
    assert share[~cut].mean() < 0.1
    rows = boundary_rows(model)
    assert np.isclose(rows.weight.sum(), 1)
    assert np.isclose(np.dot(rows.weight, rows.target), np.average(share, weights=_lengths(surface)), rtol=0.2)


def test_fitting_finds_the_model_that_made_the_data() -> None:
    rng = np.random.default_rng(0)
    features = rng.normal(size=(20_000, 2))
    target = 1 / (1 + np.exp(-(2 * features[:, 0] - features[:, 1] - 1)))
    model = fit(("a", "b"), features, target, np.ones(len(target)), ridge=1e-6)
    np.testing.assert_allclose(model.probability(features), target, atol=0.02)
    assert basis(features).shape == (20_000, 8)


def _lengths(surface):  # type: ignore[no-untyped-def]
    ends = surface.vertices[surface.edge_vertices]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
