"""Cuts by hand stay: when the slider moves, and when a job is opened again from the list."""

from helpers.browser.visit import Visit


def reopen(visit: Visit, job: str) -> None:
    """Leave a job and open it from the list."""
    visit.address(job)
    visit.page.wait_for_timeout(400)  # until the state is saved
    visit.page.click("#home")
    visit.page.wait_for_selector("#start:not([hidden])")
    visit.page.click("#open-jobs")
    visit.page.locator(f".job-row[data-id='{job}'] .job").click()
    visit.wait_for_parts()


def test_the_slider_keeps_cuts_by_hand(visit: Visit, job: str) -> None:
    visit.open_job(job, "&k=20")
    visit.viewer("(window.cut = [...v.cut])")
    merged = visit.viewer("v.tree.childrenIn(v.tree.cutAt(7), 0).find((id) => v.cut.has(id))")
    visit.show_tree()
    visit.page.locator(f"#tree [data-id='{merged}'] .twist").click()
    after = visit.parts()
    assert merged in after
    for level in (30, 20, 7, 20):
        visit.set_range("level", level)
        assert merged in visit.parts()
    assert visit.parts() == after
    assert "these cuts stay" in visit.page.inner_text("#level-note")
    visit.page.click("#discard-edits")
    assert sorted(visit.viewer("[...v.cut]")) == sorted(visit.page.evaluate("cut"))
    visit.page.click("#undo")
    assert visit.parts() == after


def test_a_split_by_hand_waits_for_the_levels_that_reach_it(visit: Visit, job: str) -> None:
    visit.open_job(job)
    part = visit.splittable()
    visit.row(part).click()
    visit.page.click("#split")
    after = visit.parts()
    visit.set_range("level", 1)
    assert visit.parts() == [0]
    visit.set_range("level", 7)
    assert visit.parts() == after


def test_a_job_opened_from_the_list_is_as_it_was_left(visit: Visit, job: str) -> None:
    visit.open_job(job)
    part = visit.splittable()
    visit.row(part).click()
    visit.page.click("#split")
    visit.page.click("#hide")
    named = visit.parts()[0]
    visit.row(named).click()
    visit.page.fill("#part-name", "Trunk")
    visit.page.keyboard.press("Enter")
    parts, hidden = visit.parts(), visit.viewer("[...v.hiddenParts]")
    visit.address("n")
    reopen(visit, job)
    assert (visit.parts(), visit.viewer("[...v.hiddenParts]")) == (parts, hidden)
    assert "Trunk" in visit.rows()


def test_a_link_of_an_earlier_version_shows_its_parts(visit: Visit, job: str) -> None:
    visit.open_job(job, "&cut=0.1.2.3.4.5.9")
    assert visit.viewer("v.tree.splitsOf(v.cut)") == visit.viewer(
        "v.tree.splitsOf(v.tree.cutOfSplits([0,1,2,3,4,5,9]))"
    )


def test_split_and_merge_are_announced(visit: Visit, job: str) -> None:
    visit.open_job(job)
    part = visit.splittable()
    name = f"segment {visit.parts().index(part)}"
    visit.row(part).click()
    for button, news in (("split", f"{name} split: "), ("merge", "parts merged into "), ("undo", "Undone: ")):
        visit.page.click(f"#{button}")
        parts = len(visit.parts())
        text = visit.page.inner_text("#announcer")
        assert news in text
        assert text.endswith(f"{parts} parts.")
