"""Accessibility of the page: keyboard, screen readers, touch, phones and the dark theme."""

from pathlib import Path
from typing import Any

import pytest

from helpers.browser.visit import NewVisit, Visit
from helpers.files.samples import OBJ

PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]


def violations(visit: Visit, axe: str) -> list[str]:
    visit.page.evaluate(axe)
    result = visit.page.evaluate("(tags) => axe.run(document, { runOnly: tags })", RULES)
    return [f"{found['id']}: {node['html']}" for found in result["violations"] for node in found["nodes"]]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_no_violation_on_the_pages(new_visit: NewVisit, job: str, axe: str, scheme: str) -> None:
    visit = new_visit(color_scheme=scheme)
    visit.open()
    assert violations(visit, axe) == []
    visit.open_job(job)
    visit.row(visit.parts()[1]).click()
    visit.settle()
    assert violations(visit, axe) == []


def test_axe_finds_no_violation_in_the_dialogs_or_with_an_error(visit: Visit, job: str, axe: str) -> None:
    visit.open_job(job)
    for button in ("open-jobs", "open-parameters", "open-download", "open-keys", "open-why"):
        visit.page.click(f"#{button}")
        visit.page.wait_for_timeout(100)
        assert violations(visit, axe) == []
        visit.page.keyboard.press("Escape")
    visit.open("#job=" + "0" * 32)
    visit.page.wait_for_selector("#problem:not([hidden])")
    assert violations(visit, axe) == []
    visit.forgive("404")


@pytest.mark.parametrize("options", [{"color_scheme": "light"}, {"color_scheme": "dark", **PHONE}])
def test_axe_finds_no_violation_in_the_list_of_several_meshes(
    new_visit: NewVisit, axe: str, tmp_path: Path, options: dict[str, Any]
) -> None:
    visit = new_visit(**options)
    visit.open()
    for name, data in {"bad.off": b"OFF\n1", "square.obj": OBJ, "notes.txt": b"x"}.items():
        (tmp_path / name).write_bytes(data)
    visit.drop_paths(*sorted(tmp_path.iterdir()))
    visit.page.wait_for_selector("#several:not([hidden])")
    assert violations(visit, axe) == []
    visit.page.wait_for_selector("#several-close:not([hidden])")
    visit.page.locator(".toast").wait_for(state="detached")
    assert violations(visit, axe) == []
    assert visit.page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_axe_finds_no_violation_on_a_phone(new_visit: NewVisit, job: str, axe: str) -> None:
    visit = new_visit(**PHONE)
    visit.open_job(job)
    assert violations(visit, axe) == []


def test_parts_are_selected_and_split_with_the_keyboard(visit: Visit, job: str) -> None:
    visit.open_job(job)
    visit.page.evaluate("document.getElementById('viewer').shadowRoot.querySelector('canvas').focus()")
    visit.page.keyboard.press("]")
    (part,) = visit.selected()
    assert part == visit.parts()[0]
    azimuth = visit.viewer("v.view.azimuth")
    visit.page.keyboard.press("ArrowRight")
    assert visit.viewer("v.view.azimuth") > azimuth
    for _ in range(7):
        if visit.viewer(f"v.tree.node({visit.selected()[0]}).children.length"):
            break
        visit.page.keyboard.press("]")
    (part,) = visit.selected()
    visit.page.keyboard.press("s")
    assert len(visit.parts()) == 6 + len(visit.viewer(f"v.tree.childrenIn(v.cut, {part})"))
    visit.page.keyboard.press("Control+z")
    assert len(visit.parts()) == 7
    visit.page.keyboard.press(".")
    end = visit.viewer("v.tree.stepEndBeside(7, 1)")
    assert len(visit.parts()) == end > 7
    visit.page.focus("#level")
    visit.page.keyboard.press("ArrowLeft")
    assert len(visit.parts()) == end - 1


def test_the_tree_is_navigated_with_arrows_and_parts_are_renamed(visit: Visit, job: str) -> None:
    visit.open_job(job)
    visit.show_tree()
    first = visit.page.locator("#tree [role=treeitem]").first
    first.focus()
    visit.page.keyboard.press("ArrowDown")
    focused = visit.page.evaluate("document.activeElement.dataset.id")
    assert focused == visit.page.locator("#tree [role=treeitem]").nth(1).get_attribute("data-id")
    visit.page.keyboard.press("End")
    visit.page.keyboard.press("Enter")
    last = int(visit.page.evaluate("document.activeElement.dataset.id"))
    assert visit.selected() == [last]
    visit.page.keyboard.press("F2")
    visit.page.keyboard.type("Last one")
    visit.page.keyboard.press("Enter")
    visit.settle()
    assert "Last one" in visit.row(last).inner_text()
    label = visit.viewer("v.shadowRoot.querySelector('canvas').getAttribute('aria-label')")
    assert "Last one" in label


def test_controls_are_large_enough_for_touch_on_a_phone(new_visit: NewVisit, job: str) -> None:
    visit = new_visit(**PHONE)
    visit.open_job(job)
    small = visit.page.evaluate(
        """() => [...document.querySelectorAll('button, input, [role=option]')]
          .filter((e) => e.checkVisibility() && !e.classList.contains('unseen'))
          .map((e) => [e.id, e.getBoundingClientRect()])
          .filter(([, box]) => box.width < 24 || box.height < 24).map(([id]) => id)"""
    )
    assert small == []
    assert visit.page.evaluate("document.documentElement.scrollWidth") == 390


def test_a_tap_selects_a_part_and_the_picture_stays_visible(new_visit: NewVisit, job: str) -> None:
    visit = new_visit(**PHONE)
    visit.open_job(job)
    part = visit.parts()[1]
    visit.page.touchscreen.tap(*visit.place_of(part))
    assert visit.selected() == [part]
    visit.settle()
    box = visit.page.locator("#viewer").bounding_box()
    assert box is not None
    assert box["y"] >= 0
    assert box["height"] >= 240


def test_the_chosen_theme_is_saved(visit: Visit) -> None:
    visit.open()
    light = visit.page.evaluate("getComputedStyle(document.body).backgroundColor")
    visit.page.click("#theme")
    visit.page.click("#theme")
    dark = visit.page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert dark != light
    visit.page.reload()
    assert visit.page.evaluate("getComputedStyle(document.body).backgroundColor") == dark
