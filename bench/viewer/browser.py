"""Headless Chromium for benchmarks of the viewer."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from playwright.sync_api import Browser

_ARGUMENTS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]


@contextmanager
def chromium(executable: Path) -> Iterator[Browser]:
    """A browser that draws with the processor.

    Raises
    ------
    BenchmarkError
        Where it is not there, or the package that steers it.
    """
    try:
        from playwright.sync_api import sync_playwright
    except ImportError as error:
        raise BenchmarkError("playwright is missing: pip install '.[test]'.") from error
    if not executable.exists():
        raise BenchmarkError(f"There is no {executable}: install the package chromium, or give --chromium.")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=_ARGUMENTS)
        yield browser
        browser.close()
