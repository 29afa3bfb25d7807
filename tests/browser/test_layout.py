"""The 3D view reaches behind the cards, the model does not, and isolated parts fill the view."""

from typing import Any

from browser.test_access import PHONE
from helpers.browser.visit import NewVisit, Visit


def box(visit: Visit, selector: str) -> dict[str, float]:
    """The top and the bottom of an element in the window."""
    found: dict[str, float] = visit.page.locator(selector).evaluate(
        "(e) => { const { top, bottom } = e.getBoundingClientRect(); return { top, bottom }; }"
    )
    return found


def seen(visit: Visit, part: int | None = None) -> list[tuple[float, float]]:
    """The points of a grid at which a part is, or any."""
    places = visit.grid(10)
    parts = zip(places, visit.parts_at(places), strict=True)
    return [place for place, found in parts if found == part or (part is None and found >= 0)]


def test_the_view_has_no_edge_above_the_level_card(visit: Visit, job: str) -> None:
    visit.open_job(job)
    assert box(visit, "#viewer")["bottom"] == box(visit, "#stage")["bottom"]
    card = box(visit, "#level-card")
    assert max(y for _, y in seen(visit)) < card["top"]
    visit.viewer("(v.view = { ...v.view, distance: 1.6 })")
    visit.settle()
    assert max(y for _, y in seen(visit)) > card["top"]


def test_tools_do_not_cover_the_view_on_a_phone(new_visit: NewVisit, job: str) -> None:
    visit = new_visit(**PHONE)
    visit.open_job(job)
    view = box(visit, "#viewer")
    assert box(visit, "#tools")["bottom"] <= view["top"]
    assert view["bottom"] <= box(visit, "#level-card")["top"]
    assert visit.page.locator("#look").is_hidden()
    visit.page.tap("#open-view")
    assert visit.page.locator("#look").is_visible()
    visit.page.tap("#open-view")
    assert visit.page.locator("#explode").is_hidden()


def test_isolated_parts_fill_the_view_until_all_are_shown(visit: Visit, job: str) -> None:
    visit.open_job(job)
    part = visit.parts()[3]
    before: dict[str, Any] = visit.viewer("v.view")
    few = len(seen(visit, part))
    visit.row(part).click()
    visit.page.click("#isolate")
    visit.settle()
    assert len(seen(visit, part)) > 2 * few
    assert set(visit.parts_at(visit.grid())) == {-1, part}
    assert visit.page.inner_text("#announcer") == "1 part of 7 shown."
    visit.page.click("#show-all")
    visit.settle()
    after = visit.viewer("v.view")
    assert abs(after["distance"] - before["distance"]) < 0.01


def test_the_api_reference_is_readable_on_a_phone(new_visit: NewVisit) -> None:
    visit = new_visit(**PHONE)
    visit.open("docs")
    assert visit.page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    visit.page.click("nav >> text=JobDocument")
    assert -1 < box(visit, "#jobdocument")["top"] < 50
    example = visit.page.locator("#jobdocument ~ pre").first
    assert '"status": "succeeded"' in example.inner_text()
    assert example.evaluate("(pre) => pre.scrollWidth <= pre.clientWidth")
    visit.page.click("text=Contents >> visible=true >> nth=-1")
    assert box(visit, "#contents")["top"] == 0
