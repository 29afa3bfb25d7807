"""The viewer command: its errors and its medians."""

from argparse import Namespace
from pathlib import Path

import pytest

from bench.commands.viewer import render, run
from bench.errors import BenchmarkError
from bench.viewer.browser import chromium
from bench.viewer.timing import Figures


def test_the_table_has_the_median_and_the_longest_update() -> None:
    brush_ms = [[0.3, 4.0, 0.5], [1.0, 9.0, 2.0]]
    figures = Figures(20480, 700.4, update_ms=[0.1, 0.9, 0.2], frame_ms=[10, 30, 20], brush_ms=brush_ms, draw_calls=2)
    text = render([900.0, 1000.0, 5000.0], [figures])
    assert "1000 ms (median of 3)" in text
    assert text.splitlines()[-1].split() == ["20,480", "700", "0.20", "0.90", "20", "0.5", "(4.0)", "2.0", "(9.0)", "2"]


def test_a_missing_browser_is_an_error_with_the_package(tmp_path: Path) -> None:
    with pytest.raises(BenchmarkError, match="install the package chromium"), chromium(tmp_path / "chromium"):
        pass


def test_a_missing_service_is_an_error_with_its_url(tmp_path: Path) -> None:
    arguments = Namespace(url="http://127.0.0.1:9", chromium=tmp_path, pictures=None)
    with pytest.raises(BenchmarkError, match="The service at"):
        run(arguments)
