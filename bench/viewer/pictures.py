"""Pictures of the viewer for docs/viewer.md."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

_DESKTOP: dict[str, Any] = {"viewport": {"width": 1280, "height": 800}}
_DARK = _DESKTOP | {"color_scheme": "dark"}
_PHONE: dict[str, Any] = {
    "viewport": {"width": 390, "height": 780},
    "device_scale_factor": 2,
    "is_mobile": True,
    "has_touch": True,
}
_TIMEOUT_MS = 300_000
_REST_MS = 1500  # until a picture is sharp, and the list of jobs has its own


def take_pictures(browser: Browser, url: str, large_job: str, folder: Path) -> None:
    """Write the pictures; the samples are sent to the service for them."""
    folder.mkdir(parents=True, exist_ok=True)
    page = _page(browser, _DESKTOP)
    jobs = {name: _sample(page, url, name) for name in ("jack", "pawn", "stool")}
    shots: list[tuple[str, dict[str, Any], str, str]] = [
        ("start", _DESKTOP, "", ""),
        ("desktop", _DESKTOP, f"#job={jobs['pawn']}", ""),
        ("selected", _DESKTOP, f"#job={jobs['pawn']}&sel=3", ""),
        ("dark", _DARK, f"#job={jobs['jack']}&explode=0.8&view=0.7_1.1_3.3_0_0_0", ""),
        ("thirty", _DESKTOP, f"#job={jobs['jack']}&k=30", ""),
        ("concavity", _DESKTOP, f"#job={jobs['jack']}&k=1&show=concavity.nolines", ""),
        ("wireframe", _DARK, f"#job={jobs['stool']}&show=wires&explode=0.5", ""),
        ("compare", _DESKTOP, f"#job={jobs['pawn']}&beside={jobs['stool']}", ""),
        ("take-away", _DESKTOP, f"#job={jobs['pawn']}", "#open-take-away"),
        ("jobs", _DARK, f"#job={jobs['stool']}", "#open-jobs"),
        ("parameters", _DESKTOP, f"#job={jobs['stool']}", "#open-parameters"),
        ("phone", _PHONE, f"#job={jobs['stool']}", ""),
        ("phone-start", _PHONE, "", ""),
        ("million", _DESKTOP, f"#job={large_job}", ""),
    ]
    page.context.close()
    for name, look, fragment, button in shots:
        _shoot(browser, look, f"{url}/{fragment}", button, folder / f"{name}.png")


def _sample(page: Page, url: str, name: str) -> str:
    """The id of the job of a sample."""
    page.goto(url)
    page.click(f"[data-sample={name}]")
    page.wait_for_selector("#work:not([hidden])")
    job: str = page.evaluate("() => new URLSearchParams(location.hash.slice(1)).get('job')")
    return job


def _shoot(browser: Browser, look: dict[str, Any], url: str, button: str, target: Path) -> None:
    page = _page(browser, look)
    page.goto(url)
    if "#" in url:
        page.wait_for_selector("#work:not([hidden])")
        page.evaluate("() => document.getElementById('viewer').figures.frame()")
    if button:
        page.click(button)
    page.wait_for_timeout(_REST_MS)
    page.screenshot(path=target)
    page.context.close()


def _page(browser: Browser, look: dict[str, Any]) -> Page:
    page = browser.new_context(reduced_motion="reduce", **look).new_page()
    page.set_default_timeout(_TIMEOUT_MS)
    return page
