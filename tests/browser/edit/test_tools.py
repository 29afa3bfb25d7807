"""The tools that edit parts: what is stored is what was drawn, and nothing is lost."""

import numpy as np
import pytest

from browser.test_access import violations
from helpers.browser.edits import EditedJob, across, choose, stroke, wait_for_preview, wait_for_revision
from helpers.browser.meshes import small_burr
from helpers.browser.visit import NewVisit, Visit
from helpers.installation import Installation


@pytest.fixture
def edited(installation: Installation) -> EditedJob:
    return EditedJob(installation.url, "burr.ply", small_burr())


def test_faces_of_the_page_are_those_of_the_file(visit: Visit, edited: EditedJob) -> None:
    visit.open_job(edited.id)
    shown = visit.viewer("[...v.labelsOfCut(v.cut)]")
    assert shown == edited.labels().tolist()
    seen = visit.viewer(
        """(() => {
          const places = Array.from({ length: 400 }, (_, i) => [200 + 15 * (i % 20), 60 + 15 * Math.floor(i / 20)]);
          v.partition = { labels: v.labelsOfCut(v.cut), colors: v.parts.map(() => '#808080') };
          return places.map((place) => [place, v.sight.at(place)]).filter(([, face]) => face >= 0)
            .map(([place, face]) => [place, v.sight.place(face)]);
        })()"""
    )
    distances = [np.hypot(a[0] - b[0], a[1] - b[1]) for a, b in seen]
    assert len(distances) > 50
    assert max(distances) < 25  # pixels from a point of a face to its middle


def test_clicks_find_a_part_and_a_click_outside_makes_it_smaller(visit: Visit, edited: EditedJob, axe: str) -> None:
    visit.open_job(edited.id, "&k=1")
    choose(visit, "part")
    middle = visit.place_of(0)
    visit.page.mouse.click(*middle)
    wait_for_preview(visit)
    assert violations(visit, axe) == []
    assert edited.get("").json()["revision"] == 0
    visit.page.keyboard.press("Escape")  # drops the marks, then the tool
    assert visit.page.locator("#edit-overlay .mark").count() == 0
    visit.page.keyboard.press("Escape")
    assert visit.page.get_attribute("[data-tool=select]", "aria-pressed") == "true"
    assert visit.parts() == [0]  # the tree, because nothing was edited
    choose(visit, "part")
    visit.page.mouse.click(*middle)
    wait_for_preview(visit)
    found = visit.selected()[0]
    corner = min(visit.grid(20), key=lambda at: (visit.parts_at([at]) != [found], at[1]))
    visit.page.keyboard.down("Alt")
    visit.page.mouse.click(*corner)
    visit.page.keyboard.up("Alt")
    visit.page.wait_for_function("() => document.querySelectorAll('#edit-overlay .mark').length === 2")
    wait_for_preview(visit)
    visit.page.click("text=Make it a part")
    wait_for_revision(visit, 1)
    labels = edited.labels()
    assert sorted(np.unique(labels)) == [0, 1]
    assert visit.page.inner_text("#edit-number") == "2"
    assert visit.selected() == [visit.parts()[1]]


def test_a_brush_moves_the_faces_under_it_and_undo_moves_them_back(visit: Visit, edited: EditedJob) -> None:
    visit.open_job(edited.id)
    before = edited.labels()
    choose(visit, "brush")
    x, y = visit.place_of(visit.parts()[0])
    visit.page.mouse.move(x, y)
    visit.page.mouse.down()
    visit.settle()
    visit.page.evaluate(
        """() => {
          window.reads = 0;
          const { readPixels } = WebGL2RenderingContext.prototype;
          WebGL2RenderingContext.prototype.readPixels = function (...rest) {
            window.reads++;
            return readPixels.apply(this, rest);
          };
        }"""
    )
    for step in range(12):
        visit.page.mouse.move(x + 3 * step, y + step)
        visit.settle()
    visit.page.keyboard.press("Escape")
    visit.page.mouse.up()
    assert visit.page.evaluate("() => window.reads") == 0
    assert edited.get("").json()["revision"] == 0  # a dropped stroke is not stored
    arm = visit.parts()[3]
    visit.row(arm).click()
    places = across(visit, visit.parts()[0])
    stroke(visit, ((places[0][0] + places[1][0]) / 2, places[0][1]), (places[1][0] - 30, places[1][1]))
    wait_for_revision(visit, 1)
    after = edited.labels()
    moved = before != after
    assert 0 < moved.sum() < len(before) / 4
    assert set(after[moved]) == {3}
    assert visit.viewer("[...v.sight.faceOf].length") == len(before)
    visit.page.keyboard.press("Control+z")
    wait_for_revision(visit, 2)
    assert (edited.labels() == before).all()
    visit.page.keyboard.press("Control+Shift+Z")
    wait_for_revision(visit, 3)
    assert (edited.labels() == after).all()


def test_strokes_change_the_parts_under_them(visit: Visit, edited: EditedJob) -> None:
    visit.open_job(edited.id)
    before = edited.labels()
    choose(visit, "lasso")
    (left, y), (right, _) = across(visit, visit.parts()[0])
    stroke(visit, (left, y - 30), (right, y - 30), (right, y + 30), (left, y + 30), (left, y - 28))
    wait_for_revision(visit, 1)
    after = edited.labels()
    assert after.max() == before.max() + 1
    assert (before[before != after] != after.max()).all()
    assert 10 < (after == after.max()).sum() < len(before) / 2  # the faces behind stay

    before = edited.labels()
    choose(visit, "cut")
    arm = visit.parts()[3]
    visit.row(arm).click()
    stroke(visit, *across(visit, arm))
    wait_for_revision(visit, 2)
    after = edited.labels()
    assert after.max() == before.max() + 1
    assert set(before[after == after.max()]) == {3}

    before = edited.labels()
    choose(visit, "border")
    stroke(visit, *across(visit, visit.parts()[2], 0.75))
    wait_for_revision(visit, 3)
    after = edited.labels()
    assert (before != after).any()
    assert set(after) <= set(before)
    visit.page.click("text=Smooth")
    wait_for_revision(visit, 4)


def test_edits_leave_locked_parts_alone_and_merge_exactly_those_that_are_selected(
    visit: Visit, edited: EditedJob
) -> None:
    visit.open_job(edited.id)
    before = edited.labels()
    first, second = visit.parts()[2], visit.parts()[5]
    visit.row(first).click()
    visit.page.locator("#merge:disabled").wait_for()
    visit.row(second).click(modifiers=["Control"])
    visit.page.click("#merge")
    wait_for_revision(visit, 1)
    after = edited.labels()
    assert (after[(before == 2) | (before == 5)] == 2).all()
    assert len(edited.parts()) == 6
    assert len(visit.selected()) == 1

    visit.row(visit.parts()[0]).click()
    visit.page.click("#part-lock")
    wait_for_revision(visit, 2)
    assert visit.page.inner_text("#part-lock") == "Unlock"
    visit.row(visit.parts()[4]).click()
    choose(visit, "brush")
    stroke(visit, *across(visit, visit.parts()[0], 0.4))
    visit.page.focus("#viewer")
    visit.page.keyboard.press("u")
    visit.page.wait_for_function("() => !document.getElementById('edit-state').textContent.endsWith(' 2.')")
    assert (edited.labels()[before == 0] == 0).all()
    choose(visit, "select")
    part = visit.selected()[0]
    visit.page.click("#isolate")
    visit.rest()
    assert set(visit.parts_at(visit.grid())) == {-1, part}


def test_levels_and_edits_do_not_replace_each_other(visit: Visit, edited: EditedJob) -> None:
    edited.post("/edits", [{"op": "merge", "parts": [2, 5]}]).raise_for_status()
    visit.open_job(edited.id)
    wait_for_revision(visit, 1)
    assert len(visit.parts()) == 6
    visit.page.click("#edit-levels")
    assert len(visit.parts()) == 7
    visit.set_range("level", 20)
    visit.page.click("#edit-back")
    wait_for_revision(visit, 1)
    assert len(visit.parts()) == 6
    visit.page.click("#edit-levels")
    visit.row(visit.parts()[3]).click()
    visit.page.click("#part-lock")
    wait_for_revision(visit, 2)
    assert len(edited.parts()) == 20
    assert len(np.unique(edited.labels(revision=1))) == 6
    visit.page.click("#undo")
    wait_for_revision(visit, 3)
    assert len(edited.parts()) == 6


def test_two_people_at_once_lose_nothing(visit: Visit, edited: EditedJob) -> None:
    visit.open_job(edited.id)
    visit.row(visit.parts()[4]).click()
    visit.page.click("#part-lock")
    wait_for_revision(visit, 1)
    edited.post("/edits", [{"op": "merge", "parts": [2, 5]}], base=1).raise_for_status()
    visit.page.fill("#part-name", "Mine")
    visit.page.keyboard.press("Enter")
    visit.page.wait_for_selector("#conflict[open]")
    assert "merge parts 2, 5" in visit.page.inner_text("#conflict-text")
    visit.page.click("#conflict [value=repeat]")
    wait_for_revision(visit, 3)
    assert len(edited.parts()) == 6
    assert [part["name"] for part in edited.parts()].count("Mine") == 1
    assert "Mine" in visit.rows()

    choose(visit, "part")
    visit.page.mouse.click(*visit.place_of(visit.parts()[1]))
    wait_for_preview(visit)
    edited.post("/edits", [{"op": "merge", "parts": [3, 5]}], base=3).raise_for_status()
    visit.page.keyboard.press("Enter")
    visit.page.click("#conflict [value=repeat]")
    wait_for_revision(visit, 5)
    assert len(edited.parts()) == 5
    assert edited.labels().max() == 4
    visit.forgive("409")


def test_all_tools_work_with_keys_alone(visit: Visit, edited: EditedJob) -> None:
    visit.open_job(edited.id)
    before = edited.labels()
    visit.page.focus("#viewer")
    visit.page.keyboard.press("p")
    visit.page.keyboard.press(" ")
    wait_for_preview(visit)
    visit.page.keyboard.press("Enter")
    wait_for_revision(visit, 1)
    assert "The part is stored" in visit.page.inner_text("#announcer")
    visit.page.keyboard.press("b")
    assert "Brush" in visit.page.inner_text("#announcer")
    visit.page.select_option("#tool-options select", "new")
    visit.page.focus("#viewer")
    visit.page.keyboard.press(" ")
    for _ in range(4):
        visit.page.keyboard.press("ArrowRight")
    visit.page.keyboard.press(" ")
    wait_for_revision(visit, 2)
    assert (edited.labels() != before).any()
    visit.page.keyboard.press("v")
    assert visit.page.get_attribute("[data-tool=select]", "aria-pressed") == "true"


def test_all_tools_work_with_a_finger(new_visit: NewVisit, edited: EditedJob) -> None:
    visit = new_visit(viewport={"width": 390, "height": 780}, has_touch=True, is_mobile=True)
    visit.open_job(edited.id)
    visit.page.tap("[data-tool=part]")
    visit.settle()  # its options take some of the height of the picture
    visit.page.touchscreen.tap(*visit.place_of(visit.parts()[1]))
    wait_for_preview(visit)
    visit.page.tap("text=Make it a part")
    wait_for_revision(visit, 1)
    before = edited.labels()
    visit.page.tap("[data-tool=brush]")
    visit.settle()
    x, y = visit.place_of(visit.parts()[0])
    visit.page.select_option("#tool-options select", "new")
    session = visit.page.context.new_cdp_session(visit.page)
    for kind, points in (
        ("touchStart", [{"x": x, "y": y}]),
        ("touchMove", [{"x": x + 12, "y": y + 5}]),
        ("touchMove", [{"x": x + 20, "y": y + 9}]),
        ("touchEnd", []),
    ):
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    wait_for_revision(visit, 2)
    after = edited.labels()
    assert set(after[after != before]) == {before.max() + 1}
    buttons = visit.page.locator("#edit-tools [data-tool]")
    assert all(box["width"] >= 44 and box["height"] >= 44 for box in (b.bounding_box() for b in buttons.all()) if box)
