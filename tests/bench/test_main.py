"""``python -m bench``: the list of commands and the errors."""

import runpy
import sys

import pytest

from bench.__main__ import main


def test_the_list_names_every_command_with_its_summary(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    listed = capsys.readouterr().out
    assert "princeton" in listed
    assert "compare" in listed
    assert "Quality on the Princeton Segmentation Benchmark" in listed


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["chess"], "no command 'chess'"),
        (["princeton", "--data", "nowhere"], "nowhere is not the folder"),
        (["princeton", "--data", "nowhere", "--parameters", "seed=1"], "--seeds"),
        (["princeton", "--data", "nowhere", "--parameters", "seeed=1"], "seeed"),
        (["princeton", "--data", "nowhere", "--parameters", "max_segments=0"], "max_segments must be"),
        (["princeton", "--data", "nowhere", "--jobs", "0"], "at least 1"),
        (["princeton", "--data", "nowhere", "--output", "no/such/folder.json"], "create it first"),
        (["compare", "nowhere.json", "nowhere.json"], "nowhere.json cannot be read"),
        (["load", "busy", "chess"], "no measurement 'chess'"),
    ],
)
def test_a_command_that_cannot_run_prints_one_sentence(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def test_the_module_bench_load_is_the_command_load(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["bench.load", "chess"])
    with pytest.raises(SystemExit) as ended:
        runpy.run_module("bench.load", run_name="__main__")
    assert ended.value.code == 2
    assert "no measurement 'chess': there are busy, waiting, levels" in capsys.readouterr().err
