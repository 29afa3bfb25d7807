"""The cheeger command on two small graphs."""

from pathlib import Path

import numpy as np
import pytest

from bench.__main__ import main
from helpers.bench.paper_models import write_benchmark

HEADER = "graph\tncc_best_known\truns5_mean20\tseconds_runs5\n"


@pytest.fixture
def references(tmp_path: Path) -> Path:
    """A path of 10 nodes with the best cut 1/9, and the same with unit volumes and the best cut 1/5."""
    edges = np.stack([np.arange(9), np.arange(1, 10)], axis=1)[:, ::-1]
    np.savez(tmp_path / "path.npz", edges=edges, weights=np.ones(9, dtype=np.float32))
    np.savez(tmp_path / "even.npz", edges=edges, weights=np.ones(9), volumes=np.ones(10))
    lines = [f"path\t{1 / 9}\t{1 / 9}\t1000\n", f"even\t{1 / 4}\t{1 / 4}\t0\n"]
    (tmp_path / "reference.tsv").write_text(HEADER + "".join(lines))
    return tmp_path


def test_every_solver_is_compared_with_the_best_known_or_found_value(
    references: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["cheeger", "--references", str(references), "--runs", "1"]) == 0
    lines = {line.split()[0]: line.split() for line in capsys.readouterr().out.splitlines() if line.split()}
    assert lines["path"][1:7] == ["10", "1.0000", "1.0000", "1.0000", "1.0000", "1.0000"]
    assert lines["even"][1:7] == lines["path"][1:7]  # 1/4 was not the best


def test_graphs_on_which_a_solver_meets_the_demand_are_counted(
    references: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["cheeger", "--references", str(references), "--runs", "1", "--solvers", "flow", "inverse_power"])
    out = capsys.readouterr().out
    for line in ("flow: at most 1.005 x ncc_best_known on 2", "inverse_power: at most 1.01 x runs5_mean20 on 2"):
        assert line in out
    assert out.count("both on 1 of 2 graphs") == 2  # no solver takes 0 seconds


def test_a_folder_without_graphs_is_rejected(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cheeger", "--references", str(tmp_path)]) == 2
    assert "is not a folder of reference graphs" in capsys.readouterr().err


def test_a_missing_graph_is_rejected(references: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (references / "even.npz").unlink()
    assert main(["cheeger", "--references", str(references)]) == 2
    assert "even.npz" in capsys.readouterr().err


def test_runs_must_be_positive(references: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cheeger", "--references", str(references), "--runs", "0"]) == 2
    assert "--runs" in capsys.readouterr().err


def test_first_cuts_of_meshes_are_measured_on_both_graphs(
    references: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data = write_benchmark(tmp_path / "data")
    assert main(["cheeger", "--references", str(references), "--data", str(data), "--runs", "1"]) == 0
    out = capsys.readouterr().out
    assert "first cuts, coarse" in out
    assert "first cuts, fine" in out
    assert "No solver for p < 2 is worse than p = 2 on any first cut." in out
