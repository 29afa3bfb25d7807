"""Headless Chromium for the benchmark of the viewer."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from playwright.sync_api import Browser

# WebGL by SwiftShader on the processor; a sandbox is not available to root and in containers.
_ARGUMENTS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]


@contextmanager
def chromium(executable: Path) -> Iterator[Browser]:
    """Start a browser that draws with the processor, and close it at the end.

    Raises
    ------
    BenchmarkError
        If the browser or the package playwright is not installed.
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
