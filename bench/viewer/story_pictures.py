"""Takes the pictures of docs/how-to/printing.md and docs/how-to/label-a-dataset.md."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from bench.viewer.devices import DESKTOP, PHONE, new_page, save_picture

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

_CLASSES = ("body", "limb")


def take_print_pictures(browser: Browser, url: str, folder: Path) -> None:
    """Check a print of a job, of which ``url`` is the link, and write pictures of it to a folder."""
    page = _checked_print(browser, url, DESKTOP)
    save_picture(page, folder / "print.png")
    page.context.close()
    page = _checked_print(browser, url, PHONE)
    page.locator("#print-report h3").last.scroll_into_view_if_needed()
    page.locator("#print .scroll").evaluate("(e) => e.scrollBy(0, 600)")
    save_picture(page, folder / "print-phone.png")
    page.context.close()


def take_label_picture(browser: Browser, url: str, jobs: list[str], folder: Path) -> None:
    """Give the parts of a job, of which ``url`` is the link, classes, among models that are labelled one by one."""
    page = new_page(browser, DESKTOP)
    page.add_init_script(_keeping("cleave.batch", {"models": [{"job": job, "name": ""} for job in jobs], "states": {}}))
    page.goto(url)
    page.wait_for_selector("#work:not([hidden]) #side [data-id]")
    page.click("#open-labels")
    page.fill("#class-list", "\n".join(_CLASSES))
    page.keyboard.press("Tab")
    page.keyboard.press("Escape")
    rows = page.locator("#list .row")
    rows.first.click()
    page.select_option("#part-class", _CLASSES[0])
    for place in range(1, rows.count()):
        rows.nth(place).click(modifiers=["Shift"] if place > 1 else [])
    page.select_option("#part-class", _CLASSES[1])
    save_picture(page, folder / "label.png")
    page.context.close()


def _checked_print(browser: Browser, url: str, device: dict[str, object]) -> Page:
    page = new_page(browser, device)
    page.goto(url)
    page.wait_for_selector("#work:not([hidden]) #side [data-id]")
    page.click("#open-download")
    page.click("[data-format=print]")
    page.fill("#print-size", "80")
    page.fill("#print-slots", "4")
    page.click("#print-form [value=report]")
    page.wait_for_selector("#print-report h3")
    return page


def _keeping(key: str, value: object) -> str:
    """Return the script that stores a value in the browser before the page reads it."""
    return f"localStorage.setItem({json.dumps(key)}, {json.dumps(json.dumps(value))})"
