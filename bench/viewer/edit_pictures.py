"""Takes the pictures of edits for docs/how-to/editing.md: a story, in which each begins at the end of the last one."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from bench.viewer.devices import DARK, DESKTOP, PHONE, new_page, save_picture

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

_NAMES = ("seat", "left leg", "right leg")

# Returns a point in the visible area of the part that is the n-th of the list, near its middle.
_PLACE = """(n) => {
  const viewer = document.getElementById('viewer');
  const { left, top, width, height } = viewer.getBoundingClientRect();
  const found = [];
  for (let x = 4; x < width; x += 8)
    for (let y = 4; y < height; y += 8)
      if (viewer.partAt(left + x, top + y) === viewer.parts[n]) found.push([left + x, top + y]);
  const middle = [0, 1].map((k) => found.reduce((sum, place) => sum + place[k], 0) / found.length);
  const away = ([x, y]) => Math.hypot(x - middle[0], y - middle[1]);
  return found.reduce((best, place) => (away(place) < away(best) ? place : best));
}"""


def take_edit_pictures(browser: Browser, url: str, folder: Path) -> None:
    """Edit the parts of a job, of which ``url`` is the link, and write pictures of it to a folder."""
    page = _opened(browser, url, DESKTOP)
    _find_part(page)
    save_picture(page, folder / "edit-part.png")
    page.keyboard.press("Enter")
    _wait_for_revision(page, 1)
    _brush(page)
    save_picture(page, folder / "edit-brush.png")
    page.mouse.up()
    _wait_for_revision(page, 2)
    page.click("[data-tool=select]")
    for place, name in enumerate(_NAMES):
        page.locator("#list .row").nth(place).click()
        page.fill("#part-name", name)
        page.keyboard.press("Enter")
        _wait_for_revision(page, 3 + place)
    page.context.close()
    page = _opened(browser, url, DARK)
    _wait_for_revision(page, 2 + len(_NAMES))
    page.locator("#list .row").nth(1).click()
    save_picture(page, folder / "edit-dark.png")
    page.context.close()
    page = _opened(browser, url, PHONE)
    _wait_for_revision(page, 2 + len(_NAMES))
    page.tap("[data-tool=part]")
    x, y = page.evaluate(_PLACE, 0)
    page.touchscreen.tap(x, y)
    page.wait_for_selector("#tool-options .primary:enabled")
    save_picture(page, folder / "edit-phone.png")
    page.context.close()


def _find_part(page: Page) -> None:
    page.click("[data-tool=part]")
    x, y = page.evaluate(_PLACE, 1)
    page.mouse.click(x, y)
    page.wait_for_selector("#tool-options .primary:enabled")


def _brush(page: Page) -> None:
    """Begin a stroke, which makes a new part."""
    page.click("[data-tool=brush]")
    page.select_option("#tool-options select", "new")
    x, y = page.evaluate(_PLACE, 0)
    page.mouse.move(x - 40, y)
    page.mouse.down()
    page.mouse.move(x + 40, y - 6, steps=12)


def _opened(browser: Browser, url: str, device: dict[str, object]) -> Page:
    page = new_page(browser, device)
    page.goto(url)
    page.wait_for_selector("#work:not([hidden]) #side [data-id]")
    return page


def _wait_for_revision(page: Page, number: int) -> None:
    page.wait_for_function(
        "(text) => document.getElementById('edit-state').textContent.endsWith(text)", arg=f"revision {number}."
    )
