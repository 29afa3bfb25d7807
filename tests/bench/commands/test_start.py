"""The table of starts, and one that is measured."""

from pathlib import Path

import pytest

from bench.__main__ import main
from bench.checkout import HERE
from bench.commands.start import render
from bench.start.measurements import COLD, SEGMENT, Seconds, Version


def test_the_table_has_medians_and_ratios_to_the_other_version() -> None:
    key = (SEGMENT, COLD)
    now = {key: [Seconds(2.0, 1.0), Seconds(9.0, 9.0), Seconds(1.0, 0.5)]}
    lines = render({"now": now, "v1": {key: [Seconds(4.0, 4.0)]}}).splitlines()
    assert lines[0].split()[-3:] == ["ratio", "CPU", "ratio"]
    assert lines[2].split()[-6:] == ["2.00", "1.00", "4.00", "4.00", "0.50", "0.25"]
    assert "ratio" not in render({"now": now})


def test_a_command_is_measured_and_must_succeed(tmp_path: Path) -> None:
    version = Version(HERE, tmp_path)
    seconds = version.run("--help")
    assert 0 < seconds.cpu < 60
    assert seconds.wall > 0
    with pytest.raises(RuntimeError, match="ended with 2"):
        version.run("segment", "nowhere.off")


def test_there_is_one_round_at_least() -> None:
    assert main(["start", "--rounds", "0"]) == 2
