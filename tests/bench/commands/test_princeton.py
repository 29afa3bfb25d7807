"""The princeton command, from its folder to its printed table."""

import json
from pathlib import Path

import pytest

from bench.__main__ import main


def test_the_command_evaluates_cleave_and_saves_what_it_prints(
    strips: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "results.json"
    options = ["--data", str(strips), "--limit", "2", "--seeds", "0,1", "--parameters", "max_segments=4"]
    assert main(["princeton", *options, "--output", str(output)]) == 0
    line = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("All models"))
    printed = line.removeprefix("All models").split()
    document = json.loads(output.read_text())
    assert (document["seeds"], document["parameters"]) == ([0, 1], {"max_segments": 4})
    assert [[run["segments"] for run in model["runs"]] for model in document["models"]] == [[3, 3], [3, 3]]
    assert printed[2] == f"{document['scores']['hamming']:.4f}"
