"""Parts are selected, hidden, split, merged and named; undo, a reload and a link keep their state."""

from helpers.browser.visit import Visit


def test_selection_is_the_same_in_the_picture_and_in_the_list(visit: Visit, job: str) -> None:
    visit.open_job(job)
    part = visit.parts()[3]
    visit.page.mouse.move(*visit.place_of(part))
    visit.page.wait_for_function("(id) => document.querySelector(`#list [data-id='${id}'].is-hovered`)", arg=part)
    visit.page.mouse.click(*visit.place_of(part))
    assert visit.selected() == [part]
    visit.settle()
    assert visit.row(part).get_attribute("aria-selected") == "true"
    other = visit.parts()[5]
    visit.row(other).hover()
    assert visit.viewer("v.hovered") == other
    visit.row(other).click(modifiers=["Shift"])
    assert visit.selected() == [part, other]


def test_the_details_of_a_part_are_those_of_the_service(visit: Visit, job: str) -> None:
    visit.open_job(job)
    nodes = visit.page.evaluate("(path) => fetch(path).then((a) => a.json())", f"v1/jobs/{job}/hierarchy")["nodes"]
    for part in visit.parts()[:3]:
        visit.row(part).click()
        visit.settle()
        assert visit.page.input_value("#part-name") == f"segment {nodes[part]['label']}"
        assert visit.page.inner_text("#detail-faces") == f"{nodes[part]['faces']:,}"
        area = 100 * nodes[part]["area"] / nodes[0]["area"]
        assert abs(float(visit.page.inner_text("#detail-area").rstrip("%")) - area) <= 0.051
        made = float(visit.page.inner_text("#detail-made"))
        assert abs(made / nodes[nodes[part]["parent"]]["cut_value"] - 1) < 0.006


def test_split_merge_undo_and_redo_change_only_the_part(visit: Visit, job: str) -> None:
    visit.open_job(job)
    before = visit.parts()
    part = visit.splittable()
    visit.row(part).click()
    sent = len(visit.requests)
    visit.page.click("#split")
    children = visit.viewer(f"v.tree.childrenIn(v.cut, {part})")
    assert sorted(visit.parts()) == sorted({*before, *children} - {part})
    assert sorted(visit.selected()) == sorted(children)
    assert visit.page.inner_text("#level-number") == str(6 + len(children))
    visit.page.click("#merge")
    assert visit.parts() == before
    visit.page.click("#undo")
    visit.page.click("#undo")
    assert visit.parts() == before
    visit.page.keyboard.press("Control+Shift+Z")
    assert sorted(visit.parts()) == sorted({*before, *children} - {part})
    assert visit.requests[sent:] == []


def test_equal_parts_are_siblings_and_the_buttons_go_from_step_to_step(visit: Visit, job: str) -> None:
    visit.open_job(job)
    visit.show_tree()
    document = visit.page.evaluate("(path) => fetch(path).then((a) => a.json())", f"v1/jobs/{job}/hierarchy")
    ball_and_arms = document["nodes"][0]["nary_children"]
    assert visit.parts() == ball_and_arms
    assert len(ball_and_arms) == 7
    assert visit.page.eval_on_selector_all("#tree .row", "(rows) => rows.map((row) => row.ariaLevel)") == ["1"] * 7
    ends = [1, 7, next(end for end in document["step_ends"] if end > 7)]
    for button, end in (("more", ends[2]), ("less", ends[1]), ("less", ends[0]), ("more", ends[1])):
        visit.page.click(f"#level-{button}")
        assert visit.page.inner_text("#level-number") == str(end)


def test_the_slider_reaches_the_numbers_within_a_step(visit: Visit, job: str) -> None:
    visit.open_job(job)
    visit.set_range("level", 4)
    visit.settle()
    assert len(visit.parts()) == 4
    assert "all of them are at 7 parts" in visit.page.inner_text("#level-note")
    assert len(visit.rows()) == 4
    inner = visit.viewer("v.parts.find((id) => v.tree.isPassedOver(id))")
    visit.row(inner).click()
    visit.page.click("#split")
    assert len(visit.parts()) == 7


def test_the_page_says_where_the_hierarchy_ends_and_why(visit: Visit, job: str) -> None:
    visit.open_job(job)
    most = visit.page.evaluate("document.getElementById('viewer').tree.maxSegments")
    assert visit.page.inner_text("#level-end") == f"The hierarchy ends at {most} parts: no sensible cut is left."


def test_hidden_parts_are_invisible_and_isolated_parts_are_shown_alone(visit: Visit, job: str) -> None:
    visit.open_job(job)
    seen = visit.parts_at(visit.grid())
    part = max(visit.parts(), key=seen.count)
    place = visit.place_of(part)
    visit.row(part).click()
    visit.page.click("#hide")
    assert visit.parts_at([place]) != [part]
    visit.page.click("#show-all")
    assert visit.parts_at([place]) == [part]
    visit.page.click("#isolate")
    assert set(visit.parts_at(visit.grid())) == {-1, part}


def test_parts_that_are_moved_apart_do_not_cover_each_other(visit: Visit, job: str) -> None:
    visit.open_job(job)
    together = visit.parts_at(visit.grid(20))
    visit.set_range("explode", 100)
    visit.settle()
    apart = visit.parts_at(visit.grid(20))
    assert together != apart
    assert len(set(apart)) >= len(set(together))


def test_a_link_restores_the_same_view(visit: Visit, job: str) -> None:
    visit.open_job(job)
    visit.row(visit.splittable()).click()
    visit.page.click("#split")
    named, hidden = visit.parts()[2], visit.parts()[4]
    visit.row(hidden).click()
    visit.page.click("#hide")
    visit.row(named).click()
    visit.page.fill("#part-name", "Left arm & co")
    visit.page.keyboard.press("Enter")
    visit.set_range("explode", 40)
    visit.page.click("#wireframe")
    visit.page.click("#up")
    visit.page.mouse.move(340, 250)
    visit.page.mouse.down()
    visit.page.mouse.move(400, 280)
    visit.page.mouse.up()
    visit.address("view=")
    visit.rest()
    state = visit.viewer(
        """JSON.stringify([v.parts, [...v.selected], [...v.hiddenParts], v.hasAttribute('wireframe'),
           v.getAttribute('explode'), v.getAttribute('up')])"""
    )
    view = visit.viewer("v.view")
    assert visit.address()["hide"] == str(hidden)
    assert "Left arm & co" in visit.rows()
    visit.page.reload()
    visit.wait_for_parts()
    assert state == visit.viewer(
        """JSON.stringify([v.parts, [...v.selected], [...v.hiddenParts], v.hasAttribute('wireframe'),
           v.getAttribute('explode'), v.getAttribute('up')])"""
    )
    assert "Left arm & co" in visit.rows()
    again = visit.viewer("v.view")
    assert abs(again["azimuth"] - view["azimuth"]) < 0.02
    assert abs(again["distance"] - view["distance"]) < 0.02


def test_a_link_with_invalid_values_shows_the_automatic_parts(visit: Visit, job: str) -> None:
    visit.open_job(job, "&k=zero&hide=9999.x&sel=-3.77777&cut=&explode=much&view=1_2&n99999=x&show=nothing&up=w")
    assert len(visit.parts()) in (1, 7)
    assert visit.selected() == []


def test_going_back_returns_to_the_previous_page(visit: Visit, job: str) -> None:
    visit.open()
    visit.page.click("#open-jobs")
    visit.page.locator(f".job-row[data-id='{job}'] .job").click()
    visit.wait_for_parts()
    visit.page.go_back()
    visit.page.wait_for_selector("#start:not([hidden])")
    visit.page.go_forward()
    visit.wait_for_parts()
