"""The comparison of constants with their neighbours, without the data of the benchmark."""

import json
from pathlib import Path

import numpy as np
import pytest

from bench.__main__ import main
from bench.commands.constants import render_cuts, render_qualities
from bench.constants.catalogue import OF_SEGMENTATIONS, OF_SOLVERS, Constant
from bench.constants.evaluation import CutQuality, Quality, cut_quality
from helpers.graphs import cycle, two_cliques
from segcore.coarsen import assembly
from segcore.label import boundary
from segcore.parameters import SegmentationParameters
from segcore.solvers.solvers import SOLVERS

CONSTANT = Constant("segcore.coarsen.assembly", "CONTACT", (0.005, 0.01), importers=("segcore.label.boundary",))


@pytest.mark.parametrize("constant", [*OF_SEGMENTATIONS, *OF_SOLVERS], ids=lambda constant: constant.name)
def test_the_value_in_force_and_neighbours_on_both_sides_are_measured(constant: Constant) -> None:
    assert constant.value in constant.values
    assert len(set(constant.values)) >= 3
    assert constant.solver in (*SOLVERS, "")
    SegmentationParameters.from_mapping(dict(constant.parameters))


def test_a_constant_is_changed_in_all_its_modules_and_restored() -> None:
    with CONSTANT.set_to(0.25):
        assert assembly.CONTACT == boundary.CONTACT == 0.25
    assert assembly.CONTACT == boundary.CONTACT == 0.01


def test_cuts_are_compared_with_the_best_known_ones() -> None:
    steps = next(constant for constant in OF_SOLVERS if constant.name == "STEPS")
    found = cut_quality(steps, 2, [cycle(10), two_cliques(5)], [0.2, 1 / 42])
    assert (found.ratio, found.worst) == pytest.approx(((1 + 2) / 2, 2))


def test_the_tables_mark_the_value_in_force_and_give_the_error_of_the_difference() -> None:
    measured = [[Quality(0.1, 0.2), Quality(0.3, 0.4)], [Quality(0.1, 0.2), Quality(0.2, 0.4)]]
    lines = render_qualities(CONSTANT, measured).splitlines()
    assert lines[2].split() == ["0.005", "0.2000", "0.0500", "0.3000", "0.0000"]
    assert lines[3].split() == ["0.01", "*", "0.1500", "0.0000", "0.3000", "0.0000"]
    rows = render_cuts(CONSTANT, [CutQuality(1.01, 1.1, 0.004), CutQuality(1.0, 1.0, 0.005)]).splitlines()
    assert rows[2].split() == ["0.005", "1.0100", "1.1000", "4.0"]


def test_the_constants_of_solvers_are_measured_on_a_folder_of_graphs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    graph = two_cliques(6)
    np.savez(tmp_path / "cliques.npz", edges=graph.edges, weights=graph.weight)
    columns = ["graph", "ncc_best_known", "runs5_mean20", "seconds_runs5"]
    lines = ["\t".join(columns), "\t".join(["cliques", json.dumps(1 / 31), "0.1", "1"])]
    (tmp_path / "reference.tsv").write_text("\n".join(lines))
    assert main(["constants", "--references", str(tmp_path), "--only", "CHECK_EVERY"]) == 0
    table = capsys.readouterr().out.splitlines()
    assert [line.split()[-3] for line in table[2:5]] == ["1.0000"] * 3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "--references"),
        (["--data", "nowhere", "--only", "PI"], "no constant 'PI'"),
        (["--data", "nowhere", "--jobs", "0"], "at least 1"),
    ],
)
def test_a_call_without_anything_to_measure_is_refused(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["constants", *arguments]) == 2
    assert message in capsys.readouterr().err
