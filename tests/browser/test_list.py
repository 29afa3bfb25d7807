"""The flat list of parts: names and numbers of the files, search, order, flags."""

import io
import json

import pytest
import trimesh

from browser.test_access import PHONE
from browser.test_download import download_as
from helpers.browser.visit import NewVisit, Visit


def shown(visit: Visit) -> list[int]:
    """The nodes in the list, from top to bottom."""
    return list(visit.page.eval_on_selector_all("#list .row", "(rows) => rows.map((row) => Number(row.dataset.id))"))


def test_names_and_numbers_are_those_of_the_files(visit: Visit, job: str) -> None:
    """Also after a cut by hand, which gives the parts other labels than the levels of the tree."""
    visit.open_job(job, "&split=40")
    inner = visit.viewer("v.tree.nodes.findLast((n) => n.children.length && n.parent >= 0 && v.cut.has(n.parent)).id")
    visit.open_job(job, f"&split={inner}")
    parts = len(visit.parts())
    assert parts > 7
    assert visit.rows() == [f"segment {number}" for number in range(parts)]
    faces = visit.viewer("v.parts.map((id) => v.tree.node(id).faces)")
    scene = trimesh.load_scene(io.BytesIO(download_as(visit, "glb")[1]), file_type="glb")
    in_file = {name: len(scene.geometry[scene.graph[name][1]].faces) for name in scene.graph.nodes_geometry}
    assert in_file == dict(zip(visit.rows(), faces, strict=True))
    labels = json.loads(download_as(visit, "json")[1])
    assert labels["names"] == visit.rows()
    assert [labels["labels"].count(number) for number in range(parts)] == faces


def test_the_list_is_searched_and_sorted(visit: Visit, job: str) -> None:
    visit.open_job(job, "&k=20")
    assert shown(visit) == visit.parts()
    visit.page.select_option("#part-sort", "size")
    areas = visit.viewer(f"{shown(visit)}.map((id) => v.tree.node(id).area)")
    assert areas == sorted(areas, reverse=True)
    part = visit.parts()[12]
    visit.row(part).click()
    visit.page.fill("#part-name", "A thumb")
    visit.page.keyboard.press("Enter")
    visit.page.select_option("#part-sort", "name")
    visit.settle()
    assert shown(visit)[0] == part
    assert visit.row(part).locator(".number").inner_text() == "12"
    for text, found in (("THUMB", [part]), ("12", [part]), ("segment 19", [visit.parts()[19]]), ("foot", [])):
        visit.page.fill("#part-search", text)
        assert shown(visit) == found
    assert visit.page.locator("#no-parts").is_visible()


def test_tiny_and_hidden_parts_are_flagged(visit: Visit, job: str) -> None:
    visit.open_job(job, "&k=64")
    tiny = visit.viewer("v.parts.filter((id) => v.tree.node(id).area < 0.001 * v.tree.totalArea)")
    flagged = visit.page.locator("#list .row", has=visit.page.get_by_text("tiny", exact=True))
    assert flagged.evaluate_all("(rows) => rows.map((row) => Number(row.dataset.id))") == tiny
    part = visit.parts()[3]
    visit.row(part).focus()
    visit.page.keyboard.press("h")
    visit.settle()
    assert visit.row(part).locator(".flag").last.inner_text() == "hidden"
    assert visit.viewer("[...v.hiddenParts]") == [part]


def test_the_list_is_walked_with_arrows(visit: Visit, job: str) -> None:
    visit.open_job(job)
    visit.page.locator("#list .row").first.focus()
    visit.page.keyboard.press("ArrowDown")
    visit.page.keyboard.press("ArrowDown")
    visit.page.keyboard.press("Enter")
    visit.settle()
    assert visit.selected() == [visit.parts()[2]]
    visit.page.keyboard.press("End")
    visit.page.keyboard.press(" ")
    assert visit.selected() == [visit.parts()[2], visit.parts()[6]]


@pytest.mark.parametrize("options", [{}, PHONE])
def test_the_first_parts_are_visible_at_once(new_visit: NewVisit, job: str, options: dict[str, object]) -> None:
    visit = new_visit(**options)
    visit.open_job(job, "&k=40")
    row = visit.page.locator("#list .row").nth(1)
    row.wait_for()
    box = row.bounding_box()
    assert box is not None
    assert visit.page.viewport_size is not None
    assert 0 < box["y"] < visit.page.viewport_size["height"] - box["height"]
