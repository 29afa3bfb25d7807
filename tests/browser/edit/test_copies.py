"""Parts that are copies of each other are marked in the list, and are named and coloured together."""

import httpx
import pytest

from helpers.browser.edits import EditedJob, wait_for_revision
from helpers.browser.meshes import small_burr
from helpers.browser.visit import Visit
from helpers.installation import Installation


@pytest.fixture
def edited(installation: Installation) -> EditedJob:
    return EditedJob(installation.url, "burr.ply", small_burr())


def equal_arms(job_url: str) -> int:
    """Return how many of the six arms the service finds equal; a border may deviate a little more than it allows."""
    document = httpx.get(f"{job_url}/parts", params={"segments": 7}, timeout=60).json()
    (repeat,) = document["repeats"]
    assert len(repeat["copies"]) >= 4
    return len(repeat["copies"])


def copies(visit: Visit, equal: int, wanted: int | None = None) -> list[int]:
    """Wait until so many rows of the list, by default all, are marked as one of equal parts; return their nodes."""
    marked = f"#list .row:has(.flag[title='{equal} equal parts'])"
    wanted = equal if wanted is None else wanted
    visit.page.wait_for_function("([css, n]) => document.querySelectorAll(css).length === n", arg=[marked, wanted])
    return [int(row.get_attribute("data-id") or "") for row in visit.page.locator(marked).all()]


def test_the_copies_of_every_level_are_marked_on_demand(visit: Visit, job: str) -> None:
    equal = equal_arms(f"{visit.url}/v1/jobs/{job}")
    visit.open_job(job)
    visit.settle()
    assert not any("/parts" in request for request in visit.requests)
    visit.page.click("#find-copies")
    assert len(set(copies(visit, equal))) == equal
    assert [url.partition("?")[2] for url in visit.requests if "/parts" in url] == ["segments=7"]
    visit.page.click("#find-copies")
    copies(visit, equal, wanted=0)


def test_all_copies_get_one_name_and_related_colours(visit: Visit, edited: EditedJob) -> None:
    equal = equal_arms(edited.url)
    visit.open_job(edited.id)
    visit.page.click("#find-copies")
    arms = copies(visit, equal)
    visit.row(arms[2]).click()
    visit.page.click("#select-copies")
    assert sorted(visit.selected()) == sorted(arms)
    visit.page.fill("#part-name", "arm")
    visit.page.keyboard.press("Enter")
    visit.settle()
    assert visit.rows().count("arm") == equal

    visit.page.click("#color-copies")
    wait_for_revision(visit, 1)
    parts = edited.parts()
    assert sorted(part["name"] for part in parts) == [*[""] * (7 - equal), *["arm"] * equal]
    document = httpx.get(f"{edited.url}/parts", params={"revision": 1}, timeout=60).json()
    (repeat,) = document["repeats"]
    related = [copy["related_color"] for copy in repeat["copies"]]
    assert [parts[copy["part"]]["color"] for copy in repeat["copies"]] == related
    assert sorted(copies(visit, equal)) == sorted(visit.selected())
    visit.page.fill("#part-name", "leg")
    visit.page.keyboard.press("Enter")
    wait_for_revision(visit, 2)
    assert sorted(part["name"] for part in edited.parts()) == [*[""] * (7 - equal), *["leg"] * equal]
