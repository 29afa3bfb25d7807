"""The tables of the paper's evaluation."""

from dataclasses import replace

import numpy as np

from bench.paper.evaluation import MethodResults
from bench.paper.tables import PAPER_SECONDS, difference_table, metric_table, rank_table, ranks, time_table
from bench.princeton.summary import overall
from helpers.bench.paper_models import Slices


def row_of(text: str, name: str) -> list[str]:
    return next(line for line in text.splitlines() if line.startswith(name)).removeprefix(name).split()


def test_a_model_on_which_a_method_fails_counts_as_one_segment_and_is_named(results: dict[str, MethodResults]) -> None:
    timid = results["timid"]
    (failed,) = timid.failures
    assert {model.model: model.runs[0].segments for model in timid.models}[failed] == 1
    text = metric_table([results["slices"], timid])
    assert f"Timid failed on model {failed}: too many faces." in text
    assert "Timid: the cut discrepancy leaves out 1 of 2 models" in text
    assert (row_of(text, "Slices")[-2:], row_of(text, "Timid")[-2:]) == (["0", "0"], ["1", "1"])


def test_equal_values_share_the_better_rank() -> None:
    assert ranks([0.3, 0.1, 0.3, 0.2]) == [3, 1, 3, 2]


def test_the_rank_table_ranks_by_category_and_over_all(results: dict[str, MethodResults]) -> None:
    slices, timid = results["slices"], results["timid"]
    text = rank_table([slices, timid])
    for name, models in (("Human", slice(0, 1)), ("Bearing", slice(1, 2)), ("All models", slice(0, 2))):
        values = [np.mean([model.scores.one_minus_rand for model in one.models[models]]) for one in (slices, timid)]
        count, rank_a, a, rank_b, b, _ = row_of(text, name)
        assert (int(count), a, b) == (len(slices.models[models]), f"{values[0]:.3f}", f"{values[1]:.3f}")
        assert [int(rank_a), int(rank_b)] == ranks(values)


def test_a_difference_is_the_second_minus_the_first(results: dict[str, MethodResults]) -> None:
    slices, timid = results["slices"], results["timid"]
    a, b = (overall(one.models).scores.one_minus_rand for one in (slices, timid))
    cells = row_of(difference_table([(slices, timid)]), "Timid against Slices")
    assert cells[:3] == [f"{a:.4f}", f"{b:.4f}", f"{b - a:.4f}"]


def test_times_are_ratios_to_the_method_of_the_paper_in_both_columns(results: dict[str, MethodResults]) -> None:
    unit = replace(results["slices"], method=Slices("inverse_power"))
    slow = replace(results["slices"], method=Slices("fiedler"))
    slower = [replace(model, runs=(replace(model.runs[0], cpu_s=1.5),)) for model in slow.models]
    text = time_table([unit, replace(slow, models=tuple(slower)), results["timid"]])
    assert row_of(text, "Inverse_power") == ["0.500", "0.500", "1.000", "69.0", "1.000", "138.0"]
    paper = PAPER_SECONDS["fiedler"]
    assert row_of(text, "Fiedler") == ["1.500", "1.500", "3.000", f"{paper}", f"{paper / 69:.3f}", f"{paper / 1.5:.1f}"]
    assert row_of(text, "Timid") == ["0.500", "0.500", "1.000", "-", "-", "-"]
