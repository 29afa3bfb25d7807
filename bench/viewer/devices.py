"""The windows in which pictures of the viewer are taken, and the pictures of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Browser, Page

DESKTOP: dict[str, Any] = {"viewport": {"width": 1280, "height": 800}}
DARK = DESKTOP | {"color_scheme": "dark"}
PHONE: dict[str, Any] = {
    "viewport": {"width": 390, "height": 780},
    "device_scale_factor": 2,
    "is_mobile": True,
    "has_touch": True,
}
_REST_MS = 1500  # until the page has drawn a sharp frame and the list of jobs; set by hand
_TIMEOUT_MS = 300_000  # the processor draws, and the largest mesh has 1.3 million faces


def new_page(browser: Browser, device: dict[str, Any]) -> Page:
    """Open a window with options of Playwright."""
    page = browser.new_context(reduced_motion="reduce", **device).new_page()
    page.set_default_timeout(_TIMEOUT_MS)
    return page


def save_picture(page: Page, target: Path) -> None:
    """Write a picture of the window at rest."""
    page.wait_for_timeout(_REST_MS)
    page.screenshot(path=target)
